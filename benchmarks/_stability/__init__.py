"""What disturbs selection, edits, words and fits, as rows with the level at which each breaks."""
