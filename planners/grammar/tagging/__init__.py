"""Tokenizes an instruction, corrects its spelling and tags its words with the word classes of the grammar."""
