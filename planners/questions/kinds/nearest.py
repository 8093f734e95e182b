"""What is nearest or farthest: "which chair is closest to the door?", "the nearest thing to me"."""

from __future__ import annotations

from ....gaussians import late_re as re
from ....gaussians.language.query.query import Query
from ....gaussians.world import kinds
from ....gaussians.world.support import is_stepped_on
from ..answer import Answer
from ..candidates import Case, agreed, unknown
from ..kind import Asked, Kind
from ..reading.noun_phrase import is_anything, is_unnamed
from ..reading.phrase_templates import templates
from ..spans import End, end_of, ends, evidence, span, told
from ..survey import NotResolved, Survey, Thing

_NEAR = "(closest|nearest|closer|nearer|next closest|most close)"
_FAR = "(farthest|furthest|most distant|farthest away|furthest away|remotest|most remote|further|farther)"
_IS = "(is|are|stands|stand|sits|sit|lies|lie|hangs|would be|comes|is standing|is sitting|is located|is placed|is the)"
_ONLY = (
    "[(standing|that stands|that stand|things that stand|only things that stand|which stand|which stands) on the floor]"
)
_WHAT = (
    "(what|which|what thing|which thing|what object|which object|which one|which item|what item|what things|what else)"
)
_TO = "(to|from|of|by|away from)"
_PHRASES = f"""
    {_WHAT} {_IS} [located] [the] N [thing|object|item|one] [{_TO}] {{b:spot}} {_ONLY}
    {_WHAT} {_IS} [the] N [{{x}}] [{_TO}] {{b:spot}} {_ONLY}
    (which|what) {{x}} {_IS} [located] [the] N [one] [{_TO}] {{b:spot}} {_ONLY}
    which of {{x}} {_IS} [the] N [{_TO}] {{b:spot}}
    {_WHAT} {_IS} the {{x}} N [{_TO}] {{b:spot}} {_ONLY}
    {_WHAT} {_IS} {{x}} N [{_TO}] {{b:spot}}
    {_WHAT} {_IS} {{x}} that is N [{_TO}] {{b:spot}}
    [(name|find|show me|give me|point out|identify|where is)] [the] N (thing|object|item) {_TO} {{b:spot}} {_ONLY}
    (name|find|show me|give me|point out|identify) [the] N {{x}} {_TO} {{b:spot}} {_ONLY}
    (name|find|show me|give me|identify) [the] {{x}} N {_TO} {{b:spot}}
    what does {{b:spot}} (stand|sit|lie|hang) N to
    (what|which thing|what thing|which object|what object|which one) BE {{b:spot}} N (to|from)
    (what|which) {{x}} BE {{b:spot}} N (to|from)
    who or what {_IS} N {_TO} {{b:spot}}
    (what|which) (thing|object|item|piece of furniture|furniture) {_IS} [at] [the] N (distance|away) {_TO} {{b:spot}}
"""
_IS_IT = f"""
    BE {{a}} [the] N [thing|object|item|one] {_TO} {{b:spot}}
    BE {{a}} the N {{x}} {_TO} {{b:spot}}
    BE {{a}} the {{x}} N {_TO} {{b:spot}}
"""
_FURNITURE = re.compile(r"\b(?:furniture|furnishing)s?\b")


def _nearest(asked: Asked, survey: Survey) -> Answer | None:
    return _extreme(asked, survey, True)


def _farthest(asked: Asked, survey: Survey) -> Answer | None:
    return _extreme(asked, survey, False)


def _is_nearest(asked: Asked, survey: Survey) -> Answer | None:
    return _is_extreme(asked, survey, True)


def _is_farthest(asked: Asked, survey: Survey) -> Answer | None:
    return _is_extreme(asked, survey, False)


def _extreme(asked: Asked, survey: Survey, near: bool) -> Answer | None:
    things = _candidates(asked, survey)
    anchors = ends(asked.slots["b"], survey, asked.situation)
    if anchors[0].is_surface:
        anchors = anchors[:1] if len(anchors) == 1 else anchors
    cases: list[Case] = [(e.name, _of_one(things, e, asked, survey, near)) for e in anchors]
    return agreed(cases)


def _of_one(things: tuple[Thing, ...], to: End, asked: Asked, survey: Survey, near: bool) -> Answer:
    ranked = _ranked(things, to, survey, near)
    if not ranked:
        return unknown("label", f"There is nothing else to compare with {to.name}.")
    best = ranked[0]
    s = span(best, to)
    assert best.thing is not None
    sure = 0.95
    text = f"{best.name} is {'nearest to' if near else 'farthest from'} {to.name}: {_gap(s.gap, to)}"
    if len(ranked) > 1:
        other = span(ranked[1], to)
        margin = abs(other.gap - s.gap) / max(s.gap, other.gap, 0.3)
        sure = 0.95 if margin > 0.15 else 0.75
        text += f"; then {ranked[1].name}, {told(other.gap)}"
    label = best.thing.label
    x = asked.slots.get("x")
    if x is not None and not is_unnamed(x) and sum(t.label == label for t in things) > 1:
        label = best.name.removeprefix("the ")
    return Answer(answer=label or best.thing.name, answer_type="label", text=f"{text[:1].upper()}{text[1:]}.",
                  confidence=sure, evidence=evidence(best, to, True, told(s.gap)))  # fmt: skip


def _gap(gap: float, to: End) -> str:
    return "they touch" if gap < 1e-3 else f"{told(gap)} away"


def _ranked(things: tuple[Thing, ...], to: End, survey: Survey, near: bool) -> list[End]:
    """Things by their gap, and by the distance of their centres where gaps are equal."""
    found = [end_of(t, survey) for t in things if to.thing is None or t.row != to.thing.row]

    def key(e: End) -> tuple[float, float]:
        s = span(e, to)
        return (round(s.gap, 2), s.centres) if near else (-s.centres, -s.gap)

    return sorted(found, key=key)


def _candidates(asked: Asked, survey: Survey) -> tuple[Thing, ...]:
    """The things that are compared: of a kind that is named, of the furniture, or everything that can be moved."""
    query: Query | None = asked.slots.get("x")
    said = asked.said
    if query is not None and not is_anything(query):
        things = survey.all_of(query)
        if not things:
            raise NotResolved(query, survey.find(query))
        return things
    things = survey.things if query is None else survey.all_of(query) or survey.things
    anchors = {e.thing.row for e in ends(asked.slots["b"], survey, asked.situation) if e.thing is not None}
    held = _carried(anchors, survey)
    kept = [t for t in things if t.row not in held and not _is_flat(t)]
    if _FURNITURE.search(said) or "on the floor" in said:
        kept = [t for t in kept if t.node is not None and t.node.support == "floor" and not _is_opening(t)]
    return tuple(kept)


def _carried(rows: set[int], survey: Survey) -> set[int]:
    """What stands on these things, and what they stand on."""
    ids = {survey.stage.ids[r] for r in rows}
    on = {t.row for t in survey.things if t.node is not None and t.node.support in ids}
    under = {t.row for t in survey.things for r in rows
             if (n := survey.at(r).node) is not None and n.support == t.id}  # fmt: skip
    return on | under


def _is_flat(thing: Thing) -> bool:
    return thing.node is not None and is_stepped_on(thing.node.support, thing.node.size[2])


def _is_opening(thing: Thing) -> bool:
    kind = kinds.of(thing.label)
    return kind is not None and (kind.opening or kind.fixed)


def _is_extreme(asked: Asked, survey: Survey, near: bool) -> Answer | None:
    """Whether one thing is the nearest: it is compared with the things of its kind that are named, or with all."""
    claimed = {t.row for t in survey.some(asked.slots["a"])}
    given = _extreme(asked, survey, near)
    if given is None or given.answer is None:
        return given and given.model_copy(update={"answer_type": "yesno"})
    if not given.evidence.ids:
        return None  # the nearest is a wall, the floor or the ceiling
    best = survey.thing(given.evidence.ids[0])
    yes = best.row in claimed
    text = f"{'Yes' if yes else 'No'}: {given.text[:1].lower()}{given.text[1:]}"
    return given.model_copy(update={"answer": "yes" if yes else "no", "answer_type": "yesno", "text": text})


KINDS = (
    Kind("nearest", templates(_PHRASES.replace(" N ", f" {_NEAR} ")), _nearest),
    Kind("farthest", templates(_PHRASES.replace(" N ", f" {_FAR} ")), _farthest),
    Kind("is_nearest", templates(_IS_IT.replace(" N ", f" {_NEAR} ")), _is_nearest),
    Kind("is_farthest", templates(_IS_IT.replace(" N ", f" {_FAR} ")), _is_farthest),
)
