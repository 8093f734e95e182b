"""The session: plan, do, check, undo; chat and command line. Knows no tensor arithmetic."""
