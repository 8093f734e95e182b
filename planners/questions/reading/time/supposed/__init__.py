"""Questions about a scene with time that no frame reads, told by their kind and the marks in their words."""
