"""Study doa-start: targets that appear, fade, cross and leave."""
