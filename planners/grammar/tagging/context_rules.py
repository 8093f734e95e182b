"""Words whose class depends on the verb or on the very next word: "back", "like", "with", "over", "'s".

Knows these words one by one, in the order in which their readings are tried. Refuses to know words that belong to one
class wherever they stand, and where clauses begin and end (tagger.py).
"""

from __future__ import annotations

from ..vocabulary import lexicon, quantities
from .lookahead import match
from .tags import Tagging
from .words import phrases

NOUNISH = frozenset({"NOUN", "ONE", "THING"})
_COLORING = ("PAINT", "TINT", "GIVE", "MAKE", "WANT", "APPLY")
# Verbs whose object "with the vase" can only describe; "move the cup with the plate" may mean both.
_POINTING = ("DELETE", "SELECT", "HIDE", "ISOLATE", "FADE", "ADJUST", "ROTATE", "SCALE", "GROW")
_ON_IT = phrases(
    "on it, on top, on top of it, in it, inside, inside it, on them, standing on it, next to it, beside it, near it, on"
)
CARRYING = phrases("that has, which has, that have, which have, that holds, that carries, holding, carrying")
_TURNING = ("TURN", "ROTATE", "TURNROUND", "FACE", "MAKE")
_FACING = phrases(
    "face, facing, to face, faces, so that it faces, so it faces, so that they face, so they face, to be facing, be "
    "facing, to look at, to look toward, to look towards, look at, look toward, look towards, to point at, to point "
    "toward, to point towards, point at, to the direction of, in the direction of, so that it is facing, "
    "so it is facing"
)
_AWAY = phrases(
    "away from, face away from, to face away from, facing away from, so that it faces away from, so it faces away "
    "from, so they face away from, its back to, to look away from"
)
_OUTSIDE = phrases("out of here, out of the room, out of the scene, out of sight, out of my sight, out of there")
_IT_IS = phrases("it is, this is, that is, there is, they are, these are")


def special(now: Tagging, i: int, length: int) -> int | None:
    """Words whose class depends on the verb or on the very next word."""
    text, rest = now.texts[i], now.texts[i + 1 :]
    after = rest[0] if rest else ""
    verb = now.clause.verb
    if (found := _owned_or_not(now, i)) is not None or (found := _around(now, i)) is not None:
        return found
    if (found := _facing(now, i)) is not None:
        return found
    if verb == "SELECT" and (pointed := _pointing(now, i)) is not None:
        return pointed
    if text in ("left", "right") and after == "by" and quantities.read(rest[1:]):
        return now.put("DIR", text, i, 1)
    if text == "like" and after in ("the", "a", "an", "my", "that", "those") and verb in ("ADD", "WANT"):
        return now.put("LIKE", None, i, 1)
    if text == "out" and verb in ("TAKE", "MOVE") and (gone := match(_OUTSIDE, now.texts, i)):
        return now.put("AWAY", None, i, gone[1])
    onward = verb == "PUT" or (verb == "MOVE" and text in ("back", "up", "over") and after in ("against", "onto"))
    if text in ("down", "over", "back", "up") and length == 1 and onward and now.read.preposition_at(i + 1):
        return i + 1
    if text in ("thing", "thingy", "thingie") and now.before == "NOUN" and verb not in ("ADD", "PUT"):
        return i + 1
    if text in ("'s", "its", "their") and after:
        return _owner(now, i)
    if text == "by" and verb in ("REPLACE", "SUBSTITUTE"):
        return now.put("WITH", None, i, 1)
    if text == "by" and after and (quantities.read(rest) or after in ("a", "half")) and length == 1:
        return now.put("BY", None, i, 1)
    if text == "into" and verb in ("TURN", "CHANGE", "MAKE"):
        return now.put("INTO", None, i, 1)
    if text == "from" and verb in ("CHANGE", "PAINT", "TURN") and now.read.hue_follows(i + 1):
        return now.put("FROMHUE", None, i, 1)
    if text in ("in", "with") and verb in _COLORING and now.read.hue_follows(i + 1):
        return i + 1 + (after in ("a", "an"))
    if text in ("on", "off") and not rest and verb == "TURN":
        return now.put("SWITCH", None, i, 1)
    if text == "over" and length == 1 and verb in ("TURN", "FLIP") and not rest:
        return now.put("UPSIDE", None, i, 1)
    if text in ("away", "out") and length == 1 and verb not in ("TAKE", "") and not rest:
        return now.put("DIR", "forward", i, 1) if verb == "MOVE" else None  # "put it away" says no place
    if text in ("closer", "nearer") and after == "to" and length == 2 and verb not in ("", "MOVE", "PUT", "TAKE"):
        return now.put("NEAR", "nearest_to", i, 2)
    if text in ("higher", "lower") and verb in ("MOVE", "PUT", "") and not now.read.nouny(i + 1):
        return now.put("DIR", "up" if text == "higher" else "down", i, 1)
    if text == "in" and rest[:2] == ("a", "row") and verb in ("COPY", "MAKE", "ADD"):
        return i + 3
    if text == "back" and length == 1 and _returns(now) and not now.read.nouny(i + 1):
        return now.put("UNKNOWN", None, i, 1)
    if text in ("each", "apiece") and not rest and now.clause.tags:
        return i + 1
    if text == "again" and verb != "SELECT" and not rest:
        return i + 1
    if text == "more" and now.before == "NUMBER" and now.read.nouny(i + 1):
        return i + 1
    return None


def _facing(now: Tagging, i: int) -> int | None:
    """What only some verbs have behind them: "turn it to face the window", "swap places", "60 cm deep"."""
    verb, text = now.clause.verb, now.texts[i]
    if len(now.clause.tags) > 1 and (found := facing_at(now, i)):
        return now.put(found[0], None, i, found[1])
    if verb == "FACE" and text in ("at", "into", "in"):
        return now.put("FACING", None, i, 1)
    if verb == "SWAP" and text in ("places", "positions", "spots", "locations", "place", "position"):
        return now.put("PLACES", None, i, 1)
    if text == "deep" and now.before == "LENGTH":
        return now.put("SIZEWORD", "deep", i, 1)
    if text in ("neither", "nor") and any(t.type == "REL" for t in now.clause.tags):
        if text == "nor":
            now.put("REL", None, i, 0)
        return now.put("NOT", None, i, 1)
    return None


def facing_at(now: Tagging, i: int) -> tuple[str, int] | None:
    """Words that say what a thing is to face, at `i`: their class and how many they are."""
    if now.clause.verb in _TURNING:
        for kind, table in (("FACEAWAY", _AWAY), ("FACING", _FACING)):
            if (found := match(table, now.texts, i)) and now.read.object_follows(i + found[1]):
                return kind, found[1]
    return None


def _pointing(now: Tagging, i: int) -> int | None:
    """ "select it is the chair …", "the chair is next to the bed": a description that is a sentence."""
    if len(now.clause.tags) == 1 and match(_IT_IS, now.texts, i):
        return i + 2
    if now.texts[i] in ("is", "are", "sits", "stands") and now.before in NOUNISH:
        behind = now.read.skip_filler(i + 1)
        behind += behind < len(now.texts) and now.texts[behind] in (*lexicon.PARTICIPLES, "the", "also")
        phrase = now.read.phrase(behind) if behind < len(now.texts) else None
        if phrase and phrase[0][0] in ("PREP", "NEAR", "BETWEEN", "SIDE", "CENTER", "SPOT", "NOT"):
            return behind
        if now.read.hue_follows(i + 1):
            return now.put("REL", None, i, 1)
    return None


def _owned_or_not(now: Tagging, i: int) -> int | None:
    """ "with the vase on it", "without a lamp": what a thing carries or lacks."""
    if (found := match(CARRYING, now.texts, i)) and now.before in NOUNISH:
        lacks = now.texts[i + found[1] : i + found[1] + 1] == ("no",)
        if now.read.object_follows(i + found[1] + lacks):
            return now.put("LACKING" if lacks else "HAVING", None, i, found[1] + lacks)
    text, behind = now.texts[i], now.texts[i + 1 : i + 2]
    if text == "with" and behind == ("no",) and now.read.object_follows(i + 2):
        return now.put("LACKING", None, i, 2)
    held = any(t.type in ("HAVING", "LACKING") for t in now.clause.tags)
    if held and (found := match(_ON_IT, now.texts, i)):
        return now.put("ONIT", "next_to" if text in ("next", "beside", "near") else "below", i, found[1])
    if text == "without" and not match(lexicon.INSIDE_PHRASES, now.texts, i) and now.read.object_follows(i + 1):
        return now.put("LACKING", None, i, 1)
    definite = behind in (("the",), ("my",)) or (behind in (("a",), ("an",)) and now.clause.verb in _POINTING)
    if text in ("with", "holding", "carrying") and definite and now.clause.verb in (*_POINTING, "PAINT", "MAKE"):
        return now.put("HAVING", None, i, 1)
    return None


def _around(now: Tagging, i: int) -> int | None:
    """ "the chairs around the table" says where they are; "a round table" what it is."""
    if now.texts[i] not in ("around", "round"):
        return None
    if now.texts[i] == "round" and now.before not in ("NOUN", "PRON") and now.read.nouny(i + 1):
        return now.put("ADJ", None, i, 1)
    turning = now.clause.verb in ("TURN", "ROTATE", "TURNROUND", "FLIP", "TILT")
    if now.before in (*NOUNISH, "AND") and now.read.object_follows(i + 1) and not turning:
        return now.put("PREP", "next_to", i, 1)
    return None


def _owner(now: Tagging, i: int) -> int:
    """ "'s", "its": of a part ("its legs") or of a property ("its size")."""
    if now.texts[i] != "'s":
        now.put("PRON", "it", i, 1)
    j = now.read.skip_filler(i + 1)
    owned = now.read.phrase(j) if j < len(now.texts) else None
    shade = now.texts[j : j + 1] == ("shade",) and bool(now.clause.tags) and "lamp" in now.clause.tags[-1].text
    of_property = owned is not None and owned[0][0] in ("COLORWORD", "OPACITYWORD", "PROP") and not shade
    return now.put("OWN" if of_property else "POSS", None, i, 1)


def _returns(now: Tagging) -> bool:
    """Whether "back" may mean where it was ("put the book back on the shelf") and not a direction."""
    return now.clause.verb in ("PUT", "TAKE") or (now.clause.verb == "MOVE" and now.before == "PRON")
