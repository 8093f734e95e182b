"""Parts of `bench view`: the server under faults, strangers, and words to bytes."""
