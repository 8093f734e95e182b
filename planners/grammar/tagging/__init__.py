"""From an instruction to tagged tokens: words, spelling, tags and context rules."""
