"""Which topics, nodes and parameters there are (no ROS import)."""
