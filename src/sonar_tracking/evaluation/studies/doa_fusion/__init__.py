"""Study doa-fusion: Ryu, Park and Choi (2003)."""
