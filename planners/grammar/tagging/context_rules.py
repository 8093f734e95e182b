"""Words whose class depends on the verb or on the very next word: "back", "like", "with", "over", "'s".

Knows these words one by one, in the order in which their readings are tried. Refuses to know words that belong to one
class wherever they stand, and where clauses begin and end (tagger.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..vocabulary import lexicon, quantities
from .lookahead import Reading, match
from .tags import Clause, Tag
from .words import Word, phrases

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


class Special:
    """A sentence, the clause being tagged, and the readers of words that need their surroundings."""

    def __init__(self, words: Sequence[Word]) -> None:
        self.words = tuple(words)
        self.texts = tuple(w.text for w in words)
        self.read = Reading(self.texts)
        self.clause = Clause()

    def _put(self, kind: str, value: Any, i: int, taken: int) -> int:
        self.clause.tags.append(Tag(kind, value, self.words[i : i + taken]))
        return i + taken

    @property
    def _before(self) -> str:
        return self.clause.tags[-1].type if self.clause.tags else ""

    def _special(self, i: int, length: int) -> int | None:
        """Words whose class depends on the verb or on the very next word."""
        text, rest = self.texts[i], self.texts[i + 1 :]
        after = rest[0] if rest else ""
        verb = self.clause.verb
        if (found := self._owned_or_not(i)) is not None or (found := self._around(i)) is not None:
            return found
        if (found := self._facing(i)) is not None:
            return found
        if verb == "SELECT" and (pointed := self._pointing(i)) is not None:
            return pointed
        if text in ("left", "right") and after == "by" and quantities.read(rest[1:]):
            return self._put("DIR", text, i, 1)
        if text == "like" and after in ("the", "a", "an", "my", "that", "those") and verb in ("ADD", "WANT"):
            return self._put("LIKE", None, i, 1)
        if text == "out" and verb in ("TAKE", "MOVE") and (gone := match(_OUTSIDE, self.texts, i)):
            return self._put("AWAY", None, i, gone[1])
        onward = verb == "PUT" or (verb == "MOVE" and text in ("back", "up", "over") and after in ("against", "onto"))
        if text in ("down", "over", "back", "up") and length == 1 and onward and self.read.preposition_at(i + 1):
            return i + 1
        if text in ("thing", "thingy", "thingie") and self._before == "NOUN" and verb not in ("ADD", "PUT"):
            return i + 1
        if text in ("'s", "its", "their") and after:
            return self._owner(i)
        if text == "by" and verb in ("REPLACE", "SUBSTITUTE"):
            return self._put("WITH", None, i, 1)
        if text == "by" and after and (quantities.read(rest) or after in ("a", "half")) and length == 1:
            return self._put("BY", None, i, 1)
        if text == "into" and verb in ("TURN", "CHANGE", "MAKE"):
            return self._put("INTO", None, i, 1)
        if text == "from" and verb in ("CHANGE", "PAINT", "TURN") and self.read.hue_follows(i + 1):
            return self._put("FROMHUE", None, i, 1)
        if text in ("in", "with") and verb in _COLORING and self.read.hue_follows(i + 1):
            return i + 1 + (after in ("a", "an"))
        if text in ("on", "off") and not rest and verb == "TURN":
            return self._put("SWITCH", None, i, 1)
        if text == "over" and length == 1 and verb in ("TURN", "FLIP") and not rest:
            return self._put("UPSIDE", None, i, 1)
        if text in ("away", "out") and length == 1 and verb not in ("TAKE", "") and not rest:
            return self._put("DIR", "forward", i, 1) if verb == "MOVE" else None  # "put it away" says no place
        if text in ("closer", "nearer") and after == "to" and length == 2 and verb not in ("", "MOVE", "PUT", "TAKE"):
            return self._put("NEAR", "nearest_to", i, 2)
        if text in ("higher", "lower") and verb in ("MOVE", "PUT", "") and not self.read.nouny(i + 1):
            return self._put("DIR", "up" if text == "higher" else "down", i, 1)
        if text == "in" and rest[:2] == ("a", "row") and verb in ("COPY", "MAKE", "ADD"):
            return i + 3
        if text == "back" and length == 1 and self._returns() and not self.read.nouny(i + 1):
            return self._put("UNKNOWN", None, i, 1)
        if text in ("each", "apiece") and not rest and self.clause.tags:
            return i + 1
        if text == "again" and verb != "SELECT" and not rest:
            return i + 1
        if text == "more" and self._before == "NUMBER" and self.read.nouny(i + 1):
            return i + 1
        return None

    def _facing(self, i: int) -> int | None:
        """What only some verbs have behind them: "turn it to face the window", "swap places", "60 cm deep"."""
        verb, text = self.clause.verb, self.texts[i]
        if len(self.clause.tags) > 1 and (found := self._facing_at(i)):
            return self._put(found[0], None, i, found[1])
        if verb == "FACE" and text in ("at", "into", "in"):
            return self._put("FACING", None, i, 1)
        if verb == "SWAP" and text in ("places", "positions", "spots", "locations", "place", "position"):
            return self._put("PLACES", None, i, 1)
        if text == "deep" and self._before == "LENGTH":
            return self._put("SIZEWORD", "deep", i, 1)
        if text in ("neither", "nor") and any(t.type == "REL" for t in self.clause.tags):
            if text == "nor":
                self._put("REL", None, i, 0)
            return self._put("NOT", None, i, 1)
        return None

    def _facing_at(self, i: int) -> tuple[str, int] | None:
        """Words that say what a thing is to face, at `i`: their class and how many they are."""
        if self.clause.verb in _TURNING:
            for kind, table in (("FACEAWAY", _AWAY), ("FACING", _FACING)):
                if (found := match(table, self.texts, i)) and self.read.object_follows(i + found[1]):
                    return kind, found[1]
        return None

    def _pointing(self, i: int) -> int | None:
        """ "select it is the chair …", "the chair is next to the bed": a description that is a sentence."""
        if len(self.clause.tags) == 1 and match(_IT_IS, self.texts, i):
            return i + 2
        if self.texts[i] in ("is", "are", "sits", "stands") and self._before in NOUNISH:
            behind = self.read.skip_filler(i + 1)
            behind += behind < len(self.texts) and self.texts[behind] in (*lexicon.PARTICIPLES, "the", "also")
            phrase = self.read.phrase(behind) if behind < len(self.texts) else None
            if phrase and phrase[0][0] in ("PREP", "NEAR", "BETWEEN", "SIDE", "CENTER", "SPOT", "NOT"):
                return behind
            if self.read.hue_follows(i + 1):
                return self._put("REL", None, i, 1)
        return None

    def _owned_or_not(self, i: int) -> int | None:
        """ "with the vase on it", "without a lamp": what a thing carries or lacks."""
        if (found := match(CARRYING, self.texts, i)) and self._before in NOUNISH:
            lacks = self.texts[i + found[1] : i + found[1] + 1] == ("no",)
            if self.read.object_follows(i + found[1] + lacks):
                return self._put("LACKING" if lacks else "HAVING", None, i, found[1] + lacks)
        text, behind = self.texts[i], self.texts[i + 1 : i + 2]
        if text == "with" and behind == ("no",) and self.read.object_follows(i + 2):
            return self._put("LACKING", None, i, 2)
        held = any(t.type in ("HAVING", "LACKING") for t in self.clause.tags)
        if held and (found := match(_ON_IT, self.texts, i)):
            return self._put("ONIT", "next_to" if text in ("next", "beside", "near") else "below", i, found[1])
        if text == "without" and not match(lexicon.INSIDE_PHRASES, self.texts, i) and self.read.object_follows(i + 1):
            return self._put("LACKING", None, i, 1)
        definite = behind in (("the",), ("my",)) or (behind in (("a",), ("an",)) and self.clause.verb in _POINTING)
        if text in ("with", "holding", "carrying") and definite and self.clause.verb in (*_POINTING, "PAINT", "MAKE"):
            return self._put("HAVING", None, i, 1)
        return None

    def _around(self, i: int) -> int | None:
        """ "the chairs around the table" says where they are; "a round table" what it is."""
        if self.texts[i] not in ("around", "round"):
            return None
        if self.texts[i] == "round" and self._before not in ("NOUN", "PRON") and self.read.nouny(i + 1):
            return self._put("ADJ", None, i, 1)
        turning = self.clause.verb in ("TURN", "ROTATE", "TURNROUND", "FLIP", "TILT")
        if self._before in (*NOUNISH, "AND") and self.read.object_follows(i + 1) and not turning:
            return self._put("PREP", "next_to", i, 1)
        return None

    def _owner(self, i: int) -> int:
        """ "'s", "its": of a part ("its legs") or of a property ("its size")."""
        if self.texts[i] != "'s":
            self._put("PRON", "it", i, 1)
        j = self.read.skip_filler(i + 1)
        owned = self.read.phrase(j) if j < len(self.texts) else None
        shade = self.texts[j : j + 1] == ("shade",) and bool(self.clause.tags) and "lamp" in self.clause.tags[-1].text
        of_property = owned is not None and owned[0][0] in ("COLORWORD", "OPACITYWORD", "PROP") and not shade
        return self._put("OWN" if of_property else "POSS", None, i, 1)

    def _returns(self) -> bool:
        """Whether "back" may mean where it was ("put the book back on the shelf") and not a direction."""
        return self.clause.verb in ("PUT", "TAKE") or (self.clause.verb == "MOVE" and self._before == "PRON")
