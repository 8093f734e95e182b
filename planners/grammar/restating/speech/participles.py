"""The participles and -ing forms of the verbs of commands: "painted" is paint, "thrown out" throw out."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from ...vocabulary import lexicon

_IRREGULAR = {
    "taken": "take", "thrown": "throw", "put": "put", "set": "set", "got": "get", "gotten": "get", "made": "make",
    "hidden": "hide", "hung": "hang", "stood": "stand", "laid": "lay", "cut": "cut", "brought": "bring",
    "given": "give", "shrunk": "shrink", "grown": "grow", "blown": "blow", "spun": "spin", "swung": "swing",
    "lost": "lose", "kept": "keep", "split": "split", "stuck": "stick", "chosen": "choose",
    "shown": "show", "found": "find", "sent": "send", "slid": "slide", "done": "do", "sat": "sit", "rid": "rid",
    "shut": "shut", "broken": "break", "bent": "bend", "lit": "light", "swept": "sweep", "torn": "tear",
    "leant": "lean", "dyed": "dye", "spray-painted": "spray", "ditched": "ditch", "stretched": "stretch",
}  # fmt: skip
_VOWELS = "aeiou"
LONGEST = 4


def _regular(verb: str) -> tuple[str, ...]:
    """The regular participles that a verb may have."""
    if verb.endswith("e"):
        return (verb + "d",)
    if verb.endswith("y") and verb[-2:-1] not in _VOWELS:
        return (verb[:-1] + "ied",)
    doubled = len(verb) > 2 and verb[-1] not in _VOWELS + "wxy" and verb[-2] in _VOWELS and verb[-3] not in _VOWELS
    return (verb + "ed", verb + verb[-1] + "ed") if doubled else (verb + "ed",)


def _gerunds(verb: str) -> tuple[str, ...]:
    """The -ing forms that a verb may have."""
    if verb.endswith("e") and not verb.endswith(("ee", "ye")):
        return (verb[:-1] + "ing",)
    doubled = len(verb) > 2 and verb[-1] not in _VOWELS + "wxy" and verb[-2] in _VOWELS and verb[-3] not in _VOWELS
    return (verb + "ing", verb + verb[-1] + "ing") if doubled else (verb + "ing",)


@cache
def _commands() -> frozenset[tuple[str, ...]]:
    """The phrases of the verbs that begin with a verb."""
    skipped = {"want", "need", "i", "we", "you", "could", "same", "the", "do", "likewise", "ditto", "one", "1", "a"}
    return frozenset(p for p in (*lexicon.VERB_PHRASES, *lexicon.UNSUPPORTED_PHRASES) if p[0] not in skipped)


@cache
def participles() -> dict[tuple[str, ...], tuple[str, ...]]:
    """The commands by their participles."""
    irregular: dict[str, list[str]] = {}
    for form, verb in _IRREGULAR.items():
        irregular.setdefault(verb, []).append(form)
    found = {
        (form, *rest): (verb, *rest)
        for verb, *rest in sorted(_commands())
        for form in (*irregular.get(verb, ()), *_regular(verb))
    }
    return found | {("got", "rid", "of"): ("delete",), ("done", "away", "with"): ("delete",)}


@cache
def gerunds() -> dict[tuple[str, ...], tuple[str, ...]]:
    """The commands by their -ing forms."""
    return {(form, *rest): (verb, *rest) for verb, *rest in sorted(_commands()) for form in _gerunds(verb)}


def at(
    table: dict[tuple[str, ...], tuple[str, ...]], said: Sequence[str], i: int
) -> tuple[tuple[str, ...], int] | None:
    """The command whose form is at `i`, and how many words the form has; None if there is none."""
    for taken in range(min(LONGEST, len(said) - i), 0, -1):
        if (command := table.get(tuple(said[i : i + taken]))) is not None:
            return command, taken
    return None
