"""`bench all`: every benchmark on one revision of the source, repeated, as one page with its charts."""
