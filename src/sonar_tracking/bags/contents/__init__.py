"""What a bag holds, and what it says of itself: messages, topics, definitions, times, losses."""
