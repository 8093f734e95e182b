"""Nouns and verbs in the words of a question: of several things one, and what they do."""

from __future__ import annotations

from ......gaussians import late_re as re
from ......gaussians.world.words import singular
from .....grammar.tagging.words import bag
from .....grammar.vocabulary.quantities import NUMBERS

_PLURAL = re.compile(r"^(?:all |both )?(?:of )?(?:the |these |those |my |our )?")

ALL_OF = re.compile(r"^(?:all|both)(?P<count> (?:two|three|four|five|2|3|4|5))?(?: of)? (?:the |these |those )?")
PRONOUNS = ("it", "he", "she", "they", "anything", "something", "everything", "things", "what", "which")

DENIED = bag("not no never without nothing nobody")
SUMMED = re.compile(
    r"\b(?:strokes both|both (?:strokes|directions)|total|altogether|cumulative|sum|summed|"
    r"adds|added|add|adding|combined|both ways|there and back|out and back|overall|outward and return|both walks)\b"
)

_DEEDS = tuple(
    (re.compile(rf"\b(?:{words})\b"), deed)
    for words, deed in (
        (r"land(?:s|ed|ing)?|hits? (?:the )?(?:floor|ground)|touch(?:es|ed)? down", "land"),
        (r"f[ae]ll(?:s|en|ing)?|drop(?:s|ped|ping)?|tumbl\w+|c[oa]mes? (?:down|off)|"
            r"plung\w+|plummet\w*|crash\w*|down|lost|off(?= the (?:\w+ )?(?:shelf|board|high))", "fall"),
        (r"stop(?:s|ped|ping)?|finish\w*|halt\w*|rest|standstill|end(?:s|ed)?|done|still", "stop"),
        (r"clos(?:e|es|ed|ing)|shut(?:s|ting)?", "close"),
        (r"open(?:s|ed|ing)?", "open"),
        (r"turn(?:s|ed|ing)?|rotat\w+|pivot\w*|swivel\w*", "turn"),
    )
)  # fmt: skip


def deed_of(rest: str, moving: str) -> str:
    """The verb of what things do."""
    return next((deed for words, deed in _DEEDS if words.search(rest)), moving)


def third_person(verb: str) -> str:
    return re.sub(r"(?<=[^s])$", "s", verb.split(" ")[0]) + verb[len(verb.split(" ")[0]) :]


def one_of(x: str) -> str:
    """Of several things the noun for one: "the books" is "book"."""
    bare = _PLURAL.sub("", x)
    words = [word for word in bare.split() if word not in NUMBERS] or bare.split()
    return " ".join((*words[:-1], singular(words[-1]))) if words else "thing"


def is_kind(x: str) -> bool:
    """Whether what is asked about is a kind of things: "the drawers", and not "the room"."""
    return x.endswith("s") and " and " not in x and several(x) not in ("things", "objects", "items", "ones", "others")


def several(x: str) -> str:
    return _PLURAL.sub("", x)


def uncounted(x: str) -> str:
    return re.sub(r"^(?:two|three|four) ", "", several(x))


def of_one(form: str) -> str:
    """A predicate of one thing: "are open" is "is open"."""
    for many, one in (("are", "is"), ("have", "has"), ("do", "does")):
        form = re.sub(rf"^{many}\b", one, form)
    return re.sub(r"^stay\b", "stays", form)
