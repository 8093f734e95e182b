"""From a query to a selection: terms, thresholds, picks, parts and colour fallback."""
