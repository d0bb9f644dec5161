"""Does an array hear as it is described: the colour of its noise, its elements, their order."""
