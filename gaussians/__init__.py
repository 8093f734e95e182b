"""What a scene *is*: clouds, cameras, harmonics, files, pixels, language features and groups.

Knows nothing of instructions, plans, language models or sessions.
"""
