"""Leaves out remarks on how things are beside an order: "it is in the way, move it", "move it, it needs light"."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ..tagging.lookahead import Lookahead
from ..tagging.words import bag
from .chunks import is_thing
from .elision import JOINTS, substitute

_SUBJECTS = bag(
    "never i we you it they he she nobody everybody everyone someone somebody people guests visitors there this "
    "that these those my our the grandma mum mom dad granny grandpa clients customers kids children"
)
_NOBODY = bag(
    "i we you it they he she there nobody everybody everyone people someone somebody guests visitors "
    "clients customers kids"
)
_REMARKING = bag(
    "use uses wobbles wobble squeaks squeak leaks leak creaks rattles flickers buzzes sags stinks smell smells "
    "clash gathers "
    "is are was were am looks look seems seem feels feel keeps keep gets get takes take blocks block "
    "bothers hates hate likes like loves love wants want needs need thinks think says said has have had "
    "does do did goes comes come coming bumping bump can could will would might may never always sits sit "
    "stands stand sticks fits fit clashes matches annoys hurts drives makes broke cost bought 's collects "
    "wastes smells works spoils ruins hides hide suits belongs sees see find finds cannot started reminds "
    "used lets got prefers"
)
_ASKING = re.compile(
    r"\b(?:should|must|ought|(?:has|have|needs?|wants?|got) to|to be|could you|can you|would you|will you|please|"
    r"instead|"
    r"would like|had better|delete|remove|paint|recolou?r|move|rotate|replace|duplicate|not|if|unless|could do "
    r"with|(?:needs?|wants?) \w+ing)\b"
)
_COAT = re.compile(r"\b(?:coat|lick|layer|splash|touch)s? of paint\b")


def is_remark(said: Sequence[str]) -> bool:
    """Whether words only say how things are: they begin with a subject, hold a verb of being, and ask for nothing."""
    text = " ".join(said)
    if _NEEDING.match(text):
        return True
    return (
        len(said) > 1
        and Lookahead(said).verb(0) is None
        and (said[0] in _SUBJECTS or said[1] in _REMARKING)
        and bool(_REMARKING & set(said))
        and not _ASKING.search(
            _COAT.sub("", text).replace("can not", "cannot").replace("do not", "").replace("does not", "")
        )
    )


def remarks(said: Sequence[str]) -> Iterator[list[str]]:
    """Readings without a remark before or behind the order: "it is in the way, move it", "move it, it needs light"."""
    for i, word in enumerate(said):
        if word not in JOINTS or not 0 < i < len(said) - 1:
            continue
        first, second = _trimmed(said[:i]), _trimmed(said[i + 1 :])
        if first and second and is_remark(first):
            thing = subject_of(first)
            filled = substitute(thing or ("it",), second)
            if filled is None or thing:
                yield filled or second
        if first and second and is_remark(second) and word != "and":
            yield first


def _trimmed(said: Sequence[str]) -> list[str]:
    words = list(said)
    while words and words[0] in JOINTS:
        words = words[1:]
    while words and words[-1] in JOINTS:
        words = words[:-1]
    return words


_THERE_IS = re.compile(r"^there (?:is|are) (?:a|an|some|one|two|three|four|this|that|these|those) (?P<thing>\S.*)$")
_NEEDING = re.compile(
    r"^(?:(?:i|we|you|it|this room|the room) )?(?:need|needs|want|wants|could use) (?:(?:more|some|a bit more|a "
    r"bit of|a little more) "
    r"(?:light|space|room|storage|seating|colou?r|air|warmth|privacy|order|variety)|(?:somewhere|something|someone|"
    r"a place|space|room|"
    r"some|more) .*|.* (?:clear|free|empty|tidy))$"
)
_LINKING = bag(
    "is are was were looks look seems seem feels feel 's clashes blocks takes needs need gets has have "
    "does do can sits stands sticks spoils ruins"
)
_BEHIND_THING = re.compile(
    r"(?: (?:any ?more|any longer|again|now|at all|there|here|really|so much|either|all the time))+$"
)


def subject_of(said: Sequence[str]) -> list[str] | None:
    """The thing that a remark is about: its subject if it says how that is, else the last thing that it names."""
    if found := _THERE_IS.match(" ".join(said)):
        return ["the", *found.group("thing").split()]
    words = _BEHIND_THING.sub("", " ".join(said)).split()
    subject: list[str] | None = None
    for i in range(1, min(len(words), 10)):
        if words[i] in _REMARKING:
            thing = tuple(words[:i])
            named = words[0] in ("the", "that", "this", "these", "those", "my", "our") or i == 1
            if words[0] not in _NOBODY and named and is_thing(thing):
                subject = list(thing)
            if subject and words[i] in _LINKING:
                return subject
            break
    for i in range(len(words) - 1, 0, -1):
        if words[i] in ("the", "that", "this", "those", "these", "my", "our") and is_thing(tuple(words[i:])):
            return list(words[i:])
    return subject
