"""One module a source of masks."""
