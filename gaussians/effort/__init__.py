"""The dial: `effort` chooses settings from measured points of time against accuracy, and says what was measured."""

from .dial import Choice, Dial, Effort, parse
from .points import WORDS, Method, Point

__all__ = ["WORDS", "Choice", "Dial", "Effort", "Method", "Point", "parse"]
