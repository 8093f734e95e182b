"""Puts orders in their order: "before you delete the vase, copy it", "in front of the sofa, add a rug".

Only what is an order on both sides is moved: "before we go to bed" is a reason, and is dropped elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...tagging.lookahead import Lookahead, match
from ...tagging.words import Word, bag
from ...vocabulary import lexicon
from ..chunks import is_thing
from ..speech.participles import at, gerunds

_ENDS = bag(". ; ! \n")
_TIMES = {"before": False, "after": True}  # whether what follows the word is done first
_FILLERS = bag("please and then , first")
_DETERMINERS = bag("the this that these those all both every each my our a an it them")


def in_order(words: Sequence[Word]) -> tuple[Word, ...]:
    """The words of an instruction with each sentence in the order in which its orders are carried out."""
    found: list[Word] = []
    start = 0
    for i in range(len(words) + 1):
        if i == len(words) or words[i].text in _ENDS:
            found += _sentence(words[start:i])
            found += words[i : i + 1]
            start = i + 1
    return tuple(found)


def _sentence(words: Sequence[Word]) -> Sequence[Word]:
    start = 0
    while start < len(words) and words[start].text in _FILLERS:
        start += 1
    said = words[start:]
    if len(said) < 4:
        return words
    return _timed_first(said) or _timed_last(said) or _placed_first(said) or words


def _timed_first(said: Sequence[Word]) -> list[Word] | None:
    """ "before you delete the vase, duplicate the mug", "after painting the sofa, move it"."""
    comma = next((i for i, w in enumerate(said) if w.text == ","), None)
    if said[0].text not in _TIMES or comma is None:
        return None
    behind = said[comma + 1 :]
    while behind and behind[0].text in _FILLERS:
        behind = behind[1:]
    order = _order(said[1:comma])
    if order is None or not _is_order(behind):
        return None
    return _joined(order, behind) if _TIMES[said[0].text] else _joined(behind, order)


def _timed_last(said: Sequence[Word]) -> list[Word] | None:
    """ "delete the clock after painting the bookshelf black", "copy the mug before you delete the vase"."""
    at_ = next((i for i, w in enumerate(said) if i and w.text in _TIMES), None)
    if at_ is None or not _is_order(said[:at_]):
        return None
    first = said[: at_ - 1] if said[at_ - 1].text == "," else said[:at_]
    order = _order(said[at_ + 1 :])
    if order is None:
        return None
    if not _TIMES[said[at_].text]:
        return _joined(first, order)
    # "paint the sofa after moving it": "it" is named behind it
    return None if any(w.text in ("it", "them") for w in order) else _joined(order, first)


def _order(said: Sequence[Word]) -> list[Word] | None:
    """What is to be done, as an order: "you delete the vase", "painting the bookshelf black"; None if it is none."""
    texts = [w.text for w in said]
    if texts[:1] == ["you"]:
        skipped = 2 if texts[1:2] == ["have"] else 1
        return list(said[skipped:]) if _is_order(said[skipped:]) else None
    form = at(gerunds(), texts, 0)
    if form is None:
        return None
    command, taken = form
    place = said[0]
    order = [*(Word(text, place.start, said[taken - 1].end) for text in command), *said[taken:]]
    return order if _is_order(order) else None


def _is_order(said: Sequence[Word]) -> bool:
    """Whether words begin with the verb of an operation and its thing."""
    texts = [w.text for w in said]
    verb = Lookahead(texts).verb(0) if texts else None
    return verb is not None and len(texts) > verb[1] and texts[verb[1]] in _DETERMINERS


def _placed_first(said: Sequence[Word]) -> list[Word] | None:
    """ "next to the sofa, add a plant": the only comma parts a place from an order."""
    commas = [i for i, w in enumerate(said) if w.text == ","]
    texts = [w.text for w in said]
    place = match(lexicon.CLOSED_PHRASES, texts, 0)
    if len(commas) != 1 or place is None or not Lookahead(texts).preposition_at(0):
        return None
    comma = commas[0]
    if not is_thing(tuple(texts[place[1] : comma])) or not _is_order(said[comma + 1 :]):
        return None
    return [*said[comma + 1 :], *said[:comma]]


def _joined(first: Sequence[Word], then: Sequence[Word]) -> list[Word]:
    """Two orders as two sentences."""
    place = then[0].start
    return [*first, Word(".", place, place), *then]
