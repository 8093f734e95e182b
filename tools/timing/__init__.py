"""Edits in scenes with time: when they hold, and how they become motion."""
