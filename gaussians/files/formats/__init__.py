"""One module a scene file format, found by scanning this package, and the codecs they share."""
