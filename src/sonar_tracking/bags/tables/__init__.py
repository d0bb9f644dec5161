"""Tables of strangers: their headings, times, angles and numbers, in text and in npz files."""
