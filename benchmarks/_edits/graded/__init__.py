"""Edits of real scenes in people's words, carried out as a user would, pictured, and graded by eye."""
