"""Make the extracts of recorded data that the studies read, from the files of their owners."""
