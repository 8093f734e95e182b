"""One module an encoder back end, found by scanning this package."""
