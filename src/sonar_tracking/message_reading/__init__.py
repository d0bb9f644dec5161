"""Messages as the records of the stages, wherever they come from: no ROS import."""
