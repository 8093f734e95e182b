"""Resolve queries to selections: terms, thresholds, picks, parts and the colour fallback."""
