"""Rosbags: write, read, recover, digest."""
