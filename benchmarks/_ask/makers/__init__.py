"""Makers of generated questions, by what they ask about."""
