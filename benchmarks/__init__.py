"""Benchmarks: one module each, with `run(quick: bool) -> Result`, found by scanning this folder.

A benchmark has the name of its file; files that begin with "_" and `harness.py` are helpers. Benchmarks may import
every package; only the command line imports them.
"""
