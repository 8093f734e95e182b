"""Words about time: when an edit holds, and what moves how."""
