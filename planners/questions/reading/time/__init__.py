"""Reads questions about scenes with time: times and spans, verbs of motion, and whole questions of them."""
