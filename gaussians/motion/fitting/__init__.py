"""Fits scenes with time to posed frames of video: what stands still, what moves, and its path."""
