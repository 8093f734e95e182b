"""Restates what people say as plain commands: smoothing of speech, corrections, wishes, and words left out."""
