"""Prompts for language models, one Markdown file each. Imports nothing; the grammar planner needs none of them."""
