"""Descriptions: of the room, of one thing, and of what kind of room it is."""

from __future__ import annotations

from ...compose.knowledge import rooms
from ..answer import Answer, Evidence
from ..candidates import meant
from ..describing import MAYBE_ROOM, SURE_ROOM, caption, describe
from ..kind import Asked, Kind, Undecided
from ..reading.noun_phrase import is_unnamed
from ..reading.phrase_templates import templates
from ..room_kind import RoomGuess, room_kinds
from ..survey import Survey, listed, with_article

_SCENE = (
    "(the room|this room|here|the scene|the whole room|this|the entire room|the place|what you see here|"
    "what you see in the room|what you see|what you can see|what is here|what i am "
    "looking at|everything)"
)
_WHAT = f"""
    (describe|summarize|summarise|sum up|outline|caption|depict|characterize) {_SCENE} [in words|briefly|in a \
      few words|in detail|in one paragraph|in a sentence|in a paragraph|for someone who can not see it]
    (give|write|provide|show) [me|us] (a|an|some|the) [short|brief|quick|detailed|general|rough|full|complete] \
      (description|overview|summary|caption|account|impression|idea) [of {_SCENE}|of what is here|of the room 's \
      contents]
    [a] [short|brief|quick|detailed] (description|overview|summary) [of {_SCENE}|please]
    what (does|do) {_SCENE} look like (from its contents|inside|overall|by its contents|\
      judging by its contents|going by its contents)
    what (can|could|do) you (tell me|say|know) about {_SCENE}
    how (would|could|can|do) you describe {_SCENE}
    how (is|was) {_SCENE} (furnished|laid out|arranged|set up|organized|organised|equipped)
    what (is|are) {_SCENE} like
    what (is|would be) the layout [of {_SCENE}]
    (describe|explain|what is) the (layout|arrangement|furnishing|furniture arrangement|contents|interior) [of \
      {_SCENE}]
    (summarize|summarise|sum up) what is in the room
    what do you see [here|in the room|in front of you]
    what am i looking at
    [about] {_SCENE} [in a nutshell]
"""
_THING = """
    describe {x} [in words|briefly|in a few words|in detail]
    (give|write) [me] (a|an) [short|brief] (description|summary) of {x}
    what (can|could|do) you (tell me|say|know) about {x}
    how (would|could|can) you describe {x}
    what (does|do) {x} look like
    [tell me] about {x}
"""
_KIND = """
    (what|which) (kind|sort|type) of [a] (room|space|place) (is|would|might|could) (this|it|that|here|the \
      room|this room) [be]
    (what|which) (kind|sort|type) of [a] (room|space|place) (do i see|do you see|am i in|are we in|am i looking \
      at|are we looking at|is shown|does it look like|does this look like|does this seem to be|does this appear \
      to be)
    (what|which) (room|space) (is|would|might|could) (this|it|that|here|the room|it of the house) [be|most likely be]
    (what|which) (room|space) (am i in|are we in|am i looking at|do i see|is shown|of the house is this|of a \
      house is this|in the house is this)
    what (is|are) (this|the|it) (room|space) [probably|likely|most likely] (used for|for|meant for|intended for|called)
    what (kind|sort|type) of room (the room|this|it) (is|seems to be|appears to be|looks like)
    what (is|would be|could be|might be) the (purpose|use|function|type|kind) of (the room|this room|this space)
    what would you call (this room|the room|this)
    what do you think (this room|the room|this) is [used for]
    what (is|was) the room (used for|for)
    what do people (use this room for|do here|do in the room)
"""
_IS_KIND = """
    (is|was) (this|it|that|here|the room|this room) [probably|likely|meant to be|supposed to be|really|more \
      like|used as] {k:room_name}
    (would|could|might|can|does) (this|it|that|the room|this room) (be|look like|seem to be|seem like|appear to \
      be|serve as|count as|pass for) {k:room_name}
    [whether] (this|it|the room|this room) is {k:room_name}
    (am i|are we) (in|looking at) {k:room_name}
"""
_WHICH_KIND = """
    (is|was) (this|it|that|the room|this room) {k:room_name} or {m:room_name}
    (is|does|would) (this|it|the room) (more|rather) [like] {k:room_name} (or|than) {m:room_name}
"""


def _describe(asked: Asked, survey: Survey) -> Answer:
    given = describe(survey)
    return Answer(answer=given.text[:4000], answer_type="text", text=given.text[:4000], confidence=0.85, frame="viewer",
                  evidence=Evidence(ids=tuple(t.id for t in given.things)))  # fmt: skip


def _thing(asked: Asked, survey: Survey) -> Answer | None:
    query = asked.slots["x"]
    if is_unnamed(query) and not query.relations and not query.last:
        return None
    things = [t for t in meant(query, survey) if t.node is not None]
    if not things:
        return None
    text = " ".join(f"{c.text[0].upper()}{c.text[1:]}" for c in (caption(t, survey) for t in things[:12]))
    return Answer(answer=text[:4000], answer_type="text", text=text[:4000], confidence=0.85, frame="viewer",
                  evidence=Evidence(ids=tuple(t.id for t in things)))  # fmt: skip


def _ids(guess: RoomGuess, survey: Survey) -> tuple[int | str, ...]:
    from ....gaussians.world import kinds

    return tuple(t.id for t in survey.things if (k := kinds.of(t.label)) is not None and k.name in guess.signs)


def _kind(asked: Asked, survey: Survey) -> Answer | Undecided:
    """The kind of room that fits best, if one does."""
    guesses = room_kinds(survey.with_sure_names())
    if not guesses or guesses[0].probability < MAYBE_ROOM:
        near = [with_article(g.name) for g in guesses[:3]]
        why = f"It may be {', '.join(near)}: " if near else ""
        return Undecided(f"{why}what stands here does not tell the kind of room.", sight=True, answer_type="label",
                         confidence=0.6)  # fmt: skip
    best = guesses[0]
    sure = best.probability >= SURE_ROOM
    text = f"{'' if sure else 'Perhaps '}{with_article(best.name)}: there {_are(best)}."
    return Answer(answer=best.name, answer_type="label", text=text[0].upper() + text[1:], confidence=best.probability,
                  evidence=Evidence(ids=_ids(best, survey)))  # fmt: skip


def _are(guess: RoomGuess) -> str:
    named = [with_article(s) for s in guess.signs]
    return f"{'is' if len(named) == 1 else 'are'} {listed(named)}"


def _is_kind(asked: Asked, survey: Survey) -> Answer | Undecided:
    name = asked.slots["k"]
    guesses = {g.name: g for g in room_kinds(survey.with_sure_names())}
    if not guesses:
        return Undecided("Too few things have a name to tell the kind of room.", sight=True, answer_type="yesno")
    best = next(iter(guesses.values()))
    share = guesses[name].probability if name in guesses else 0.0
    if max(share, best.probability - share) < MAYBE_ROOM:
        return Undecided(
            "What stands here does not tell the kind of room.", sight=True, answer_type="yesno", confidence=0.6
        )
    holds = share >= 0.5 or name == best.name
    reason = f"there {_are(best)}" if holds else f"what stands here is more like {with_article(best.name)}"
    return Answer(answer="yes" if holds else "no", answer_type="yesno", text=f"{'Yes' if holds else 'No'}: {reason}.",
                  confidence=max(share if holds else 1 - share, 0.5) * 0.95,
                  evidence=Evidence(ids=_ids(best, survey)))  # fmt: skip


def _which_kind(asked: Asked, survey: Survey) -> Answer | Undecided:
    guesses = {g.name: g for g in room_kinds(survey.with_sure_names())}
    named = [guesses[asked.slots[n]] for n in ("k", "m") if asked.slots[n] in guesses]
    assert all(asked.slots[n] in rooms() for n in ("k", "m"))
    if not named:
        return Undecided(
            "What stands here does not tell which of them it is.", sight=True, answer_type="label", confidence=0.6
        )
    best = max(named, key=lambda g: g.probability)
    text = f"{with_article(best.name).capitalize()}: there {_are(best)}."
    return Answer(answer=best.name, answer_type="label", text=text,
                  confidence=max(best.probability, 0.5), evidence=Evidence(ids=_ids(best, survey)))  # fmt: skip


KINDS = (
    Kind("kind of room", templates(_KIND), _kind),
    Kind("which kind of room", templates(_WHICH_KIND), _which_kind),
    Kind("is it that kind of room", templates(_IS_KIND), _is_kind),
    Kind("description", templates(_WHAT), _describe),
    Kind("description of a thing", templates(_THING), _thing),
)
