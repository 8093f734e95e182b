"""The verbs of the command line, one small file each: `command` takes what was typed and prints what came of it.

A verb's module imports nothing heavy at module level, so that `scenewright --help` is instant.
"""
