"""Times in numbers whatever words stand beside them: the last resort for words with a mark of time.

"On the move from 1 sec to 3 sec" tells two ends, since its mark says that it is a time and it holds two numbers; what
the other words say does not matter, unless they are about another number or about what happens.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .....gaussians import late_re as re
from ...tagging.words import bag
from ...vocabulary.quantities import NUMBERS, ORDINALS
from ..moments import Moment, seconds_of

_LONGEST = 6  # words of a duration
_OTHERWISE = bag(  # words by which a number may be another one, or the time another one
    "not never nor every each except unless than earlier sooner later ago plus minus more less longer shorter extra "
    "another m cm mm metres meters metre meter centimetres centimeters degrees degree deg ° % percent times turns turn "
    "revolutions rpm fps frames frame drawers drawer books book chairs chair walls wall doors door leg lap walk walks "
    "remaining other"
)
_BEHIND = bag("after behind past following upon once when while whenever since into")  # from what a time counts
_FIRST, _LAST = bag("first opening initial"), bag("last final closing")
_UNITS = bag("s sec secs second seconds")


def numbered(tag: str, phrase: str) -> Moment | None:
    """The time that the numbers in words with a mark tell; None if they tell none.

    Args:
        tag: that of the mark: `from`, `to`, `in` or `for`.
        phrase: its words.
    """
    words = phrase.replace(". .", "…").split()
    values = list(_values(words))
    if not values or (_OTHERWISE | _BEHIND) & set(words):
        return None
    told = [value for value, _, _ in values]
    if len(told) == 2 and tag in ("in", "from") and told[0] < told[1]:
        return Moment(start=told[0], stop=told[1], said=(phrase,))
    if len(set(told)) > 1:
        return None
    said = set(words)
    if tag == "for":
        holds = words[0] == "for"
        return Moment(lasting=told[0], taken=not holds, said=(phrase,)) if told[0] > 0 else None
    if tag == "in":
        if _FIRST & said:
            return Moment(stop=told[0], said=(phrase,))
        return Moment(start=-told[0], said=(phrase,)) if _LAST & said else None
    if (_FIRST | _LAST) & said:
        return None
    return Moment(start=told[0], said=(phrase,)) if tag == "from" else Moment(stop=told[0], said=(phrase,))


def _values(words: Sequence[str]) -> Iterator[tuple[float, int, int]]:
    """The numbers among words in seconds, and from where to where each of them stands."""
    at = 0
    while at < len(words):
        for end in range(min(len(words), at + _LONGEST), at, -1):
            if (value := _value(words[at:end], words[at - 1] if at else "")) is not None:
                yield value, at, end
                at = end
                break
        else:
            at += 1


def _value(words: Sequence[str], before: str) -> float | None:
    """The seconds that words name, behind another word."""
    said = " ".join(words)
    if len(words) == 1 and words[0] in ("a", "an", "first", *_UNITS):
        return 2.0 if (words[0], before) == ("second", "the") else None
    if words[0] in ORDINALS and len(words) <= 2 and set(words[1:]) <= _UNITS:  # "the second second"
        return float(ORDINALS[words[0]])
    if re.fullmatch(r"\d+(?:\.\d+)?", said):
        return float(said)
    if said in NUMBERS:
        return float(NUMBERS[said])
    return seconds_of(said) if words[0] not in _UNITS else None
