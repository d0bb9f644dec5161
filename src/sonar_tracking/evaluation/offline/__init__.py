"""The chains in one process, without ROS."""
