"""Edits of a scene: one file for each atomic operation, their registry, their post-conditions and their receipts.

Operations carry no trace of their source: a sentence, a model, a script and a test are treated alike.
"""
