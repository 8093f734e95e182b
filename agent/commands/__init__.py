"""The verbs of the command line, one module each: `command` takes the arguments and prints the result.

These modules import nothing heavy at module level, so that `scenewright --help` stays fast.
"""
