"""From the words of a question to filled phrase templates."""
