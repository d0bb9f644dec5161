"""Malformed messages, made from good ones with knowledge of their structure, for every node."""
