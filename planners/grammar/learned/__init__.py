"""What is told of a sentence by models that learned from written ones: its kind, and which words name what."""
