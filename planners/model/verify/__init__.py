"""Validation of a language model's answers: parsing, and semantic checks of the plan against the scene graph."""
