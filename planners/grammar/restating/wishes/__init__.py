"""Restates wishes, states and judgements as commands."""
