"""All targets of a listener: which bearing and which line is whose, the stage that holds them."""
