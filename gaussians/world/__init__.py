"""The one description of the world: kinds of things, words, lengths, relations, boxes, support and people."""
