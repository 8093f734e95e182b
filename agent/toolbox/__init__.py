"""The functions that language models and other programs call on a session: typed, bounded, and one at a time."""
