"""How a scene *changes* and is *measured*: one file per atomic operation, the registry, post-conditions, receipts.

Never knows where an operation came from: a sentence, a model, a script and a test look the same here.
"""
