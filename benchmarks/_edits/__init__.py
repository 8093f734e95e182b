"""Measurements of edits on real scenes."""
