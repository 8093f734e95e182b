"""Rooms with moving things, films of them with the truth, and what bench motion measures on them."""
