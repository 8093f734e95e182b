"""Parts of `bench fill`: rooms with a known empty truth, and measures of filled pictures."""
