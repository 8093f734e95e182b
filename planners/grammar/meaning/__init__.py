"""Turns parse trees into queries and edit operations."""
