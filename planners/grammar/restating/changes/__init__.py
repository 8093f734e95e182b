"""Restates changes that the grammar knows by plainer words: materials, holes, continuations, rewordings."""
