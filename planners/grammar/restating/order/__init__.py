"""Puts the parts of a sentence in the order of a command and fills in those that it leaves out."""
