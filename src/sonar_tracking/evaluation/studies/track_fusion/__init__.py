"""Study track-fusion: one picture of echoes and bearings, beside other rules and the bound."""
