"""From a parse tree to queries and operations."""
