"""Files of MCAP: written, read, and what can be had of damaged ones."""
