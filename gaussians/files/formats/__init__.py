"""One module per scene file format, found by scanning this package, and the codecs that formats share."""
