"""Reads answers that mean a portion of what is listed: "the red part of 3", "2 without the wall", "pieces of 1".

What the words mean in the scene is found by `gaussians.language.query.portions`.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from ...gaussians import late_re as re
from ...gaussians.color import shade_of
from ...gaussians.errors import UserError
from ...gaussians.language.field.apart import set_apart
from ...gaussians.language.query import portions
from ...gaussians.language.query.palette import palette
from ...gaussians.language.query.terms import STRUCTURE, is_name
from ...gaussians.world.relation_geometry import viewer_stand
from .answers import chosen_numbers, plain
from .sight import bare

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...gaussians.camera import Camera
    from ...gaussians.language.query.query import Query
    from ...gaussians.language.query.selection import Candidate
    from ...gaussians.scene import Scene

Kind = Literal["colors", "side", "behind", "numbers", "whole", "pieces"]

MOST_PIECES = 8  # of one group
_SIDES = {"left": "left", "right": "right", "front": "front", "near": "front", "nearer": "front", "back": "back",
          "rear": "back", "far": "back", "farther": "back", "top": "top", "upper": "top", "bottom": "bottom",
          "lower": "bottom"}  # fmt: skip
_BEHIND = frozenset({*STRUCTURE, "background", "what is behind", "what is behind it", "rest", "surroundings"})
_LONGEST = 200  # characters of an answer
_PART = r"(?:parts?|bits?|pieces?|areas?|halves|half|side|end|ones?|things?|stuff|section|region)"
_NUM = r"(?:numbers? |nos?\. ?|#)?\d[\d\s,;&+#-]*(?:(?:and|to|or|through) ?#?\d[\d\s,;&+#-]*)*"
_LEAD = re.compile(r"^(?:(?:no|yes|but|please|take|use|i mean|just|only|it is|it's|that is|change|of)[,:]? )+")
_PIECES = (
    re.compile(rf"(?:show )?(?:me )?(?:the |some |a )?(?:smaller |finer |single )?{_PART} (?:of|in|inside) ({_NUM})"),
    re.compile(rf"(?:split|divide|zoom(?: in)?(?: on| into)?|smaller than|inside|in|within) ({_NUM})"),
    re.compile(rf"({_NUM}) in (?:smaller |finer )?{_PART}"),
)
_FINER = re.compile(
    r"(?:show (?:me )?)?(?:(?:something|things?|pieces|parts|ones|objects?) )?(?:smaller|finer|tinier)"
    r"(?: (?:pieces?|parts?|things?|ones?|objects?))?|zoom(?: in)?"
    r"|(?:the |its |their )?(?:pieces|parts)(?: of (?:it|them))?"
)
_WHOLE = re.compile(rf"(?:all|the whole|whole|the whole thing|everything|all parts)(?: of)? ({_NUM})")
_ALL_OF_IT = re.compile(r"(?:all|everything|the whole)(?: of (?:it|them|that)| thing)|the lot|the whole")
_WITHOUT = re.compile(
    rf"(?:({_NUM}),? ?)?(?:all )?(?:but )?(?:without|but not|not|except(?: for)?|minus|less|leave out|leaving out)"
    rf" (?:the |its )?(.+?)(?: {_PART})?"
)
_OF = re.compile(rf"(?:the )?(.+?)(?: (?:colou?red )?{_PART})? (?:of|in|on|from|at) ({_NUM}|it|them|that|all|those)")
_ONLY = re.compile(rf"({_NUM}),?:? (?:but )?(?:only |just )(?:the )?(.+?)(?: {_PART})?")
_COLON = re.compile(rf"({_NUM})[,:]? (?:the )?(.+?) {_PART}")
_ALONE = re.compile(r"(?:the )?(.+?) (?:parts?|bits?|pieces?|areas?|half|side|end)(?: only| alone)?")
_AND = re.compile(r",? (?:and|plus|with) |, ")


@dataclass(frozen=True)
class Portion:
    """What an answer means of a list.

    Attributes:
        kind: how the portion is told.
        places: of the list, from 0.
        words: colours or a side, as `portions` knows them.
        less: places that are left out, for "numbers".
        without: what the words tell is left out, and the rest is meant.
        more: further portions that are meant too.
    """

    kind: Kind
    places: tuple[int, ...]
    words: tuple[str, ...] = ()
    less: tuple[int, ...] = ()
    without: bool = False
    more: tuple[Portion, ...] = ()


def read(text: str, count: int, *, single: bool = False) -> Portion | None:
    """The portion of a list of `count` that an answer means; None if it means none.

    Args:
        single: the list is one thing to confirm, so that an answer needs no number: "only the red part".

    >>> read("the red part of 2", 3).words, read("3 without 1", 3).less, read("1 and 2", 3)
    (('red',), (0,), None)
    """
    said = plain(text)
    if len(said) > _LONGEST or count < 1 or chosen_numbers(said, count) is not None:
        return None
    said = _core(said)
    found = _one(said, count, single=single)
    return _united(said, count) if found is None else found


def _core(said: str) -> str:
    return _LEAD.sub("", said).removesuffix(" please").removesuffix(" only")


def _one(said: str, count: int, *, single: bool = False) -> Portion | None:
    """The one portion that a text without further ones means; None if it means none."""
    for pattern in _PIECES:
        if (match := pattern.fullmatch(said)) and (places := chosen_numbers(match[1], count)):
            return Portion("pieces", places)
    if _FINER.fullmatch(said):
        return Portion("pieces", ())
    if (match := _WHOLE.fullmatch(said)) and (places := chosen_numbers(match[1], count)):
        return Portion("whole", places)
    if single and _ALL_OF_IT.fullmatch(said):
        return Portion("whole", tuple(range(count)))
    found = _without(said, count) or _narrowed(said, count)
    return found if single or re.search(r"\d", said) else None


def _united(said: str, count: int) -> Portion | None:
    """Several portions that are meant together: "1 and the red part of 3"; None if one of them cannot be read."""
    cuts = [(match.start(), match.end()) for match in _AND.finditer(said)]

    # An answer has up to 70 cuts. What follows each is read once, not again for every reading of what is before it.
    @functools.cache
    def rest(begin: int) -> Portion | None:
        if (last := _item(said[begin:], count)) is not None:
            return last
        for end, following in cuts:
            if end > begin and (first := _item(said[begin:end], count)) and (others := rest(following)):
                return replace(first, more=(replace(others, more=()), *others.more))
        return None

    return rest(0)


def _item(said: str, count: int) -> Portion | None:
    if (places := chosen_numbers(said, count)) is not None:
        return Portion("numbers", places)
    found = _one(_core(plain(said)), count)
    return found if found is not None and found.kind != "pieces" else None


def _without(said: str, count: int) -> Portion | None:
    match = _WITHOUT.fullmatch(said)
    if match is None:
        return None
    places = tuple(range(count)) if match[1] is None else chosen_numbers(match[1], count)
    if places is None:
        return None
    if match[1] is not None and (less := chosen_numbers(match[2], count)) is not None:
        return Portion("numbers", places, less=less)
    found = _attribute(match[2], places)
    return None if found is None else replace(found, without=True)


def _narrowed(said: str, count: int) -> Portion | None:
    for pattern, number, words in ((_OF, 2, 1), (_ONLY, 1, 2), (_COLON, 1, 2), (_ALONE, None, 1)):
        match = pattern.fullmatch(said)
        if match is None:
            continue
        every = number is None or not re.search(r"\d", match[number])
        places = tuple(range(count)) if every else chosen_numbers(match[number or 0], count)
        found = _attribute(match[words], places) if places else None
        if found is None or found.kind == "behind":
            continue
        if found.kind == "colors" or said.startswith("the ") or re.search(rf" {_PART}( |$)", said):
            return found
    return None


def _attribute(said: str, places: tuple[int, ...]) -> Portion | None:
    """The colours or the side that some words name; None if they name neither."""
    said = said.removeprefix("only ").removeprefix("the ").removesuffix(" colored").removesuffix(" coloured")
    words = [w.removeprefix("the ") for w in re.split(r",? and |,? or |[,/]", said) if w]
    if len(words) == 1 and words[0] in _SIDES:
        return Portion("side", places, (_SIDES[words[0]],))
    if said in _BEHIND:
        return Portion("behind", places)
    try:
        for word in words:
            shade_of(word)
    except UserError:
        return None
    return Portion("colors", places, tuple(words)) if words else None


def taken(
    scene: Scene, portion: Portion, query: Query, candidates: Sequence[Candidate], viewer: Camera
) -> tuple[Scene, Query]:
    """The scene in which a portion is a group of its own, with the name of the query, and the query that means it.

    A portion of what was offered as a part, or is asked for as a part, stays a part of its object.

    Raises:
        UserError: nothing of what was chosen is of that colour, side or kind; or all of it is. The message says what is
            there.
    """
    assert scene.language is not None
    field, every = scene.language, [portion, *portion.more]
    meant = [candidates[i] for p in every for i in p.places]
    groups = [c.group for c in meant]
    if any(c.ids is None and not 0 <= c.group < len(field.groups) for c in meant):
        raise UserError("a part of that one cannot be chosen; say where it is ('the left one'), or 'all'")
    rows = np.unique(np.concatenate([_rows(scene, p, candidates, viewer) for p in every]))
    owned = any(r.name == "part_of" for r in query.relations) or all(
        g >= 0 and field.groups[g].level == "part" for g in groups
    )
    name = query.text if is_name(query.text) and not owned else ""
    after, group = set_apart(scene, rows, name, "user", part=owned)
    return after, bare(query).model_copy(update={"groups": (group,), "confirmed": True})


def pieces(scene: Scene, groups: Sequence[int]) -> tuple[Scene, tuple[int, ...]]:
    """The scene in which some groups are in pieces, and the ids of these, which are parts of what they were.

    A group is divided where shape and colour say most clearly that two things touch, or else by its colours. One that
    cannot be divided is a piece of itself.
    """
    assert scene.language is not None
    found: list[int] = []
    for group in groups:
        field = scene.language
        assert field is not None
        if known := [i for i in field.parts.get(group, ()) if field.groups[i].count]:
            found += known
            continue
        every = portions.rows_of(scene, [group])
        divided = [rows for rows in portions.pieces_of_rows(scene, every, MOST_PIECES) if len(rows)]
        for rows in divided if len(divided) > 1 else ():
            scene, piece = set_apart(scene, rows, part=True)
            found.append(piece)
        found += [group] if len(divided) < 2 else []
    return scene, tuple(dict.fromkeys(found))


def _rows(scene: Scene, portion: Portion, candidates: Sequence[Candidate], viewer: Camera) -> portions.I64:
    """The rows of one portion, ascending; raises as `taken`."""
    field = scene.language
    assert field is not None
    every = portions.rows_of_candidates(scene, [candidates[i] for i in portion.places])
    if portion.kind in ("numbers", "whole"):
        found = np.setdiff1d(
            every, portions.rows_of_candidates(scene, [candidates[i] for i in portion.less]), assume_unique=True
        )
        if not len(found):
            raise UserError("nothing would be left of it")
        return found
    if portion.kind == "side":
        stand = viewer_stand(viewer, scene.frame.up_vector, field.typical_size, field.middle)
        found = portions.of_side(scene, every, portion.words[0], stand)
    elif portion.kind == "behind":
        found = portions.of_what_is_behind(scene, every)
    else:
        found = portions.of_colors(scene, every, portion.words)
    found = np.setdiff1d(every, found, assume_unique=True) if portion.without else found
    if len(found) and (len(found) < len(every) or not portion.without):
        return found
    colors = f"its colours are {palette(scene, every).told()}"
    raise UserError(
        f"nothing of it is left without that; {colors}" if portion.without and not len(found)
        else f"there is no such part in it; {colors}"
    )  # fmt: skip
