"""Rooms furnished from a seed: layout, recipes, assembly and viewpoints."""
