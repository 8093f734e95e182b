"""The language field: its table of groups, how it is measured, built and stored."""
