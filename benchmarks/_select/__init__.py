"""What `bench select` measures, a measure a module: each takes cases and an encoder and returns a `Part`.

Truth is read only here and only after the answer is there. Nobody but `benchmarks.select` looks in.
"""
