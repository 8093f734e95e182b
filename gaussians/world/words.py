"""Words of a noun phrase, brought to one form before an encoder with a finite vocabulary sees them.

Knows English articles, plural endings and the "a photo of" habit. Refuses to know which words an encoder has learnt.
"""

from __future__ import annotations

import re

PROMPT = "a photo of a {}"  # what encoders trained on captions of photographs are shown a name as

_WORD = re.compile(r"[a-z0-9]+")
_FRAMED = re.compile(
    r"^(?:an? |the )?(?:(?:close ?up|cropped|blurry|good|bad) )?(?:photo|photograph|picture|image|rendering|view)"
    r" of (?=\w)"
)
_DETERMINERS = frozenset("a an the some any my your our his her their its this that these those".split())  # noqa: SIM905

# Plurals the endings below would get wrong, and words that end in s and are singular.
_IRREGULAR = {
    "shelves": "shelf", "bookshelves": "bookshelf", "knives": "knife", "leaves": "leaf", "halves": "half",
    "lenses": "lens", "cookies": "cookie", "movies": "movie", "people": "person", "children": "child", "feet": "foot",
    "mice": "mouse", "men": "man", "women": "woman", "teeth": "tooth", "gas": "gas", "canvas": "canvas", "lens": "lens",
    "buses": "bus", "axes": "axe", "shoes": "shoe", "aches": "ache", "caches": "cache", "ties": "tie", "pies": "pie",
}  # fmt: skip


def singular(word: str) -> str:
    """One lower-case word without its plural ending: "couches" to "couch". Applying it twice changes nothing more."""
    if word in _IRREGULAR:
        return _IRREGULAR[word]
    if len(word) < 4 or not word.endswith("s") or word.endswith(("ss", "us", "is")):
        return word
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    if word.endswith(("ches", "shes", "sses", "xes", "zes")):
        return word[:-2]
    return word[:-1]


def normalise(text: str) -> tuple[str, ...]:
    """The words that carry meaning, lower-case and singular: "A photo of the red Couches" to `("red", "couch")`."""
    plain = " ".join(_WORD.findall(text.lower().replace("'s", " ")))
    plain = _FRAMED.sub("", plain)
    return tuple(singular(w) for w in plain.split() if w not in _DETERMINERS)
