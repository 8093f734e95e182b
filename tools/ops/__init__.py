"""One file per operation; each defines one `EditOp` subclass, found by scanning this package."""
