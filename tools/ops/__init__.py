"""The operations, one file each: a file defines one `EditOp` subclass, which the registry finds by a scan."""
