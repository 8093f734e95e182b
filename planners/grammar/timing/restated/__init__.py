"""Turns of phrase about time and motion, and the same in words that the readers know."""
