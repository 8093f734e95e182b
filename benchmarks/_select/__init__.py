"""The measures of `bench select`, one module each: a measure takes cases and an encoder and returns a `Part`.

The ground truth is used only to judge an answer, never to find it.
"""
