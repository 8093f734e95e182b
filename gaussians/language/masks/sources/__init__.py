"""The sources of masks, one module each."""
