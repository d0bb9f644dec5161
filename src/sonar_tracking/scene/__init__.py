"""Where everything is, for pictures: frames of own ship and of the sensors."""
