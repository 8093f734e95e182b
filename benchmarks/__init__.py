"""What is measured: one benchmark a file, each with `run(quick: bool) -> Result`, found by scanning this folder.

A benchmark's name is its file's name; files that begin with "_" and `harness.py` are tools. Knows every room. Nobody
but the command line looks in here.
"""
