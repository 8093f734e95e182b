"""A room description in words, read into a brief."""
