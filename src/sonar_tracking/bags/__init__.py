"""Rosbags and recorded data: write, read, recover, import."""
