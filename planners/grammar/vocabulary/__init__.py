"""The vocabulary of the grammar planner: nouns, verbs, quantities and the closed word classes."""
