"""Tags words whose class depends on the verb or on the next word: "back", "like", "with", "over", "'s".

Each rule handles a few words; `tag_by_context` tries the rules in order. Words that have one class everywhere, and the
boundaries of clauses, are handled in tagger.py.
"""

from __future__ import annotations

from ..vocabulary import lexicon, quantities
from .lookahead import match
from .region_words import tag_region
from .tags import TaggerState
from .words import phrases

NOUNISH = frozenset({"NOUN", "ONE", "THING"})
_COLORING_VERBS = ("PAINT", "TINT", "GIVE", "MAKE", "WANT", "APPLY")
# After these verbs "with the vase" can only describe the object; "move the cup with the plate" is ambiguous.
_DESCRIBING_VERBS = ("DELETE", "SELECT", "HIDE", "ISOLATE", "FADE", "ADJUST", "ROTATE", "SCALE", "GROW")
_ON_IT = phrases(
    "on it, on top, on top of it, in it, inside, inside it, on them, standing on it, next to it, beside it, near it, on"
)
_JOINTS = {"with": "AND", "including": "AND", "without": "BUT"}
CARRYING = phrases("that has, which has, that have, which have, that holds, that carries, holding, carrying")
_TURNING_VERBS = ("TURN", "ROTATE", "TURNROUND", "FACE", "MAKE")
_FACING = phrases(
    "face, facing, to face, faces, so that it faces, so it faces, so that they face, so they face, to be facing, be "
    "facing, to look at, to look toward, to look towards, look at, look toward, look towards, to point at, to point "
    "toward, to point towards, point at, to the direction of, in the direction of, so that it is facing, "
    "so it is facing, until it faces, until they face, till it faces, until it is facing, so as to face, so it "
    "looks at, "
    "so that it looks at, so it points at, so that it points at, until it looks at, until it points at, so that "
    "they are "
    "facing, so they are facing, round to face, around to face, turned towards"
)
_AWAY = phrases(
    "away from, face away from, to face away from, facing away from, so that it faces away from, so it faces away "
    "from, so they face away from, its back to, to look away from"
)
_OUTSIDE = phrases("out of here, out of the room, out of the scene, out of sight, out of my sight, out of there")
_IT_IS = phrases("it is, this is, that is, there is, they are, these are")


def tag_by_context(state: TaggerState, i: int, length: int) -> int | None:
    """Tag the word at `i` if a rule applies to it.

    Args:
        length: how many words the closed vocabulary would tag at `i`, 0 for none.

    Returns:
        The position behind the tagged or dropped words; None if no rule applies.
    """
    text, rest = state.texts[i], state.texts[i + 1 :]
    after = rest[0] if rest else ""
    verb = state.clause.verb
    if (found := tag_region(state, i)) is not None:
        return found
    if verb == "SCALESO" and text in ("is", "are", "becomes", "measures"):
        return i + 1
    if verb == "CROP" and text in ("with", "including") and state.ahead.object_follows(i + 1):
        return state.emit("AND", None, i, 1)
    if (found := _tag_having_or_lacking(state, i)) is not None or (found := _tag_around(state, i)) is not None:
        return found
    if (found := _tag_after_verb(state, i)) is not None:
        return found
    if verb == "SELECT" and (pointed := _tag_described(state, i)) is not None:
        return pointed
    if text in ("left", "right") and after == "by" and quantities.read(rest[1:]):
        return state.emit("DIR", text, i, 1)
    if text == "like" and after in ("the", "a", "an", "my", "that", "those") and verb in ("ADD", "WANT"):
        return state.emit("LIKE", None, i, 1)
    if text == "out" and verb in ("TAKE", "MOVE") and (gone := match(_OUTSIDE, state.texts, i)):
        return state.emit("AWAY", None, i, gone[1])
    onward = verb == "PUT" or (verb == "MOVE" and text in ("back", "up", "over") and after in ("against", "onto"))
    if text in ("down", "over", "back", "up") and length == 1 and onward and state.ahead.preposition_at(i + 1):
        return i + 1
    if text in ("thing", "thingy", "thingie") and state.last_type == "NOUN" and verb not in ("ADD", "PUT"):
        return i + 1
    if after in ("its", "their") and state.last_type in NOUNISH and (joint := _JOINTS.get(text)):
        return state.emit(joint, None, i, 1)  # "the plant with its pot"
    if text == "shade" and [t.type for t in state.clause.tags[-2:]] == ["PRON", "POSS"]:
        return state.emit("NOUN", text, i, 1)
    if text in ("'s", "its", "their") and after:
        return _tag_possessive(state, i)
    if text == "with" and verb in ("MERGE", "TAKE") and state.ahead.object_follows(i + 1):
        return state.emit("WITH", None, i, 1)
    if text == "into" and verb == "SPLIT" and length == 1:
        return state.emit("INTO", None, i, 1)
    if text == "by" and verb in ("REPLACE", "SUBSTITUTE"):
        return state.emit("WITH", None, i, 1)
    if text == "by" and after and (quantities.read(rest) or after in ("a", "half")) and length == 1:
        return state.emit("BY", None, i, 1)
    if text == "into" and verb in ("TURN", "CHANGE", "MAKE"):
        return state.emit("INTO", None, i, 1)
    if text == "from" and verb in ("CHANGE", "PAINT", "TURN") and state.ahead.hue_follows(i + 1):
        return state.emit("FROMHUE", None, i, 1)
    if text in ("in", "with") and verb in _COLORING_VERBS and state.ahead.hue_follows(i + 1):
        return i + 1 + (after in ("a", "an"))
    if (
        text in ("on", "off")
        and verb == "TURN"
        and (not rest or (length == 0 or after in ("at", "in", "by", "over", "above")))
    ):
        return state.emit("SWITCH", None, i, 1)
    if text == "over" and length == 1 and verb in ("TURN", "FLIP") and not rest:
        return state.emit("UPSIDE", None, i, 1)
    if text in ("away", "out") and length == 1 and verb not in ("TAKE", "") and not rest:
        return state.emit("DIR", "forward", i, 1) if verb == "MOVE" else None  # "put it away" says no place
    if text == "away" and after == "from" and length == 2 and verb == "TAKE":  # "take it away from the table"
        return state.emit("AWAY", None, i, 1)
    if text in ("closer", "nearer") and after == "to" and length == 2 and verb not in ("", "MOVE", "PUT", "TAKE"):
        return state.emit("NEAR", "nearest_to", i, 2)
    if text in ("higher", "lower") and verb in ("MOVE", "PUT", "") and not state.ahead.noun_at(i + 1):
        return state.emit("DIR", "up" if text == "higher" else "down", i, 1)
    if text == "in" and rest[:2] == ("a", "row") and verb in ("COPY", "MAKE", "ADD"):
        return i + 3
    if text == "back" and length == 1 and _back_means_return(state) and not state.ahead.noun_at(i + 1):
        return state.emit("UNKNOWN", None, i, 1)
    if text in ("each", "apiece") and not rest and state.clause.tags:
        return i + 1
    if text == "again" and verb != "SELECT" and not rest:
        return i + 1
    if text == "more" and state.last_type == "NUMBER" and state.ahead.noun_at(i + 1):
        return i + 1
    return None


def _tag_after_verb(state: TaggerState, i: int) -> int | None:
    """Tag words that only certain verbs or tags precede: "turn it to face the window", "swap places", "60 cm deep"."""
    verb, text = state.clause.verb, state.texts[i]
    if len(state.clause.tags) > 1 and (found := facing_at(state, i)):
        return state.emit(found[0], None, i, found[1])
    if verb == "FACE" and text in ("at", "into", "in"):
        return state.emit("FACING", None, i, 1)
    if verb == "SWAP" and text in ("places", "positions", "spots", "locations", "place", "position"):
        return state.emit("PLACES", None, i, 1)
    if text == "deep" and state.last_type == "LENGTH":
        return state.emit("SIZEWORD", "deep", i, 1)
    if text == "or" and [t.type for t in state.clause.tags[-2:]] == ["NOT", "HUE"] and state.ahead.hue_follows(i + 1):
        state.emit("REL", None, i, 0)
        return state.emit("NOT", None, i, 1)
    if text in ("neither", "nor") and any(t.type == "REL" for t in state.clause.tags):
        if text == "nor":
            state.emit("REL", None, i, 0)
        return state.emit("NOT", None, i, 1)
    return None


def facing_at(state: TaggerState, i: int) -> tuple[str, int] | None:
    """The phrase at `i` that says what a thing should face ("facing", "away from"): its class and number of words."""
    if state.clause.verb in _TURNING_VERBS:
        for kind, table in (("FACEAWAY", _AWAY), ("FACING", _FACING)):
            if (found := match(table, state.texts, i)) and state.ahead.object_follows(i + found[1]):
                return kind, found[1]
    return None


def _tag_described(state: TaggerState, i: int) -> int | None:
    """Tag descriptions that are full sentences: "select it is the chair …", "the chair is next to the bed"."""
    if len(state.clause.tags) == 1 and match(_IT_IS, state.texts, i):
        return i + 2
    if state.texts[i] in ("is", "are", "sits", "stands") and state.last_type in NOUNISH:
        behind = state.ahead.skip_filler(i + 1)
        behind += behind < len(state.texts) and state.texts[behind] in (*lexicon.PARTICIPLES, "the", "also")
        phrase = state.ahead.phrase(behind) if behind < len(state.texts) else None
        if phrase and phrase[0][0] in ("PREP", "NEAR", "BETWEEN", "SIDE", "CENTER", "SPOT", "NOT"):
            return behind
        if state.ahead.hue_follows(i + 1):
            return state.emit("REL", None, i, 1)
    return None


def _tag_having_or_lacking(state: TaggerState, i: int) -> int | None:
    """Tag what a thing carries or lacks: "with the vase on it", "without a lamp"."""
    if (found := match(CARRYING, state.texts, i)) and state.last_type in NOUNISH:
        lacks = state.texts[i + found[1] : i + found[1] + 1] == ("no",)
        if state.ahead.object_follows(i + found[1] + lacks):
            return state.emit("LACKING" if lacks else "HAVING", None, i, found[1] + lacks)
    text, behind = state.texts[i], state.texts[i + 1 : i + 2]
    if text == "with" and behind == ("no",) and state.ahead.object_follows(i + 2):
        return state.emit("LACKING", None, i, 2)
    held = any(t.type in ("HAVING", "LACKING") for t in state.clause.tags)
    if held and (found := match(_ON_IT, state.texts, i)):
        return state.emit("ONIT", "next_to" if text in ("next", "beside", "near") else "below", i, found[1])
    if text == "without" and not match(lexicon.CLOSED_PHRASES, state.texts, i) and state.ahead.object_follows(i + 1):
        return state.emit("LACKING", None, i, 1)
    definite = behind in (("the",), ("my",)) or (behind in (("a",), ("an",)) and state.clause.verb in _DESCRIBING_VERBS)
    if (
        text in ("with", "holding", "carrying")
        and definite
        and state.clause.verb in (*_DESCRIBING_VERBS, "PAINT", "MAKE")
    ):
        return state.emit("HAVING", None, i, 1)
    return None


def _tag_around(state: TaggerState, i: int) -> int | None:
    """Tag "around" and "round": a preposition in "the chairs around the table", an adjective in "a round table"."""
    if state.texts[i] not in ("around", "round"):
        return None
    if state.texts[i] == "round" and state.last_type not in ("NOUN", "PRON") and state.ahead.noun_at(i + 1):
        return state.emit("ADJ", None, i, 1)
    turning = state.clause.verb in ("TURN", "ROTATE", "TURNROUND", "FLIP", "TILT")
    if state.last_type in (*NOUNISH, "AND") and state.ahead.object_follows(i + 1) and not turning:
        return state.emit("PREP", "next_to", i, 1)
    return None


def _tag_possessive(state: TaggerState, i: int) -> int:
    """Tag a possessive ("'s", "its"): POSS before a part ("its legs"), OWN before a property ("its size")."""
    lamp = bool(state.clause.tags) and any("lamp" in tag.text for tag in state.clause.tags)
    if state.texts[i] != "'s":
        state.emit("PRON", "it", i, 1)
    j = state.ahead.skip_filler(i + 1)
    owned = state.ahead.phrase(j) if j < len(state.texts) else None
    shade = lamp and state.texts[j : j + 1] == ("shade",)
    of_property = owned is not None and owned[0][0] in ("COLORWORD", "OPACITYWORD", "PROP") and not shade
    return state.emit("OWN" if of_property else "POSS", None, i, 1)


def _back_means_return(state: TaggerState) -> bool:
    """Whether "back" may mean the previous place ("put the book back on the shelf") rather than a direction."""
    return state.clause.verb in ("PUT", "TAKE") or (state.clause.verb == "MOVE" and state.last_type == "PRON")
