"""Reads a clause about light as the fields of `relight`, if every word of it is understood.

Words are matched with the phrases of `vocabulary`, longest first, and read from left to right: a degree, an amount or
"more" counts for the change that follows it, at the end for the last one. A clause without a word for light, a place or
a time of day is not about light ("make it darker" is about a thing).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from ....gaussians import late_re as re
from ..tagging.words import bag, phrases
from ..vocabulary import quantities
from .tokens import Token, tokens_of
from .vocabulary import Meaning, needs_light

# Factor of exposure without a degree, for "a bit", for "much".
UP: dict[str, float] = {"": 1.5, "little": 1.22, "much": 2.5}
DOWN: dict[str, float] = {"": 0.62, "little": 0.8, "much": 0.35}
# Warmth and contrast likewise.
WARMTH: dict[str, float] = {"": 0.5, "little": 0.25, "much": 0.8}
CONTRAST: dict[str, float] = {"": 1.2, "little": 1.1, "much": 1.4}
_CONTRASTS = {"soft": 0.82, "dramatic": 1.3}  # of the words for soft and for hard light
_STOP = 2.0  # factor of one stop of exposure
_ASKS = bag(
    "make let give turn set change can could would will please want need needs should must adjust get bring have show "
    "put add use try render create how imagine pretend wish prefer do switch go be to"
)
_NEVER = bag("never nothing without undo again")
_QUESTIONS = bag("is are was were does did what where which who why when whose has am")
_FORBIDDEN = re.compile(r"\b(?:do|does|should|must|would|shall) not (?:be |get |go )?(?!want|like|need|have|enough)")
_LIKING = phrases("i like, i love, i hate, we like, we love, i enjoy, you like")
_LINKS = bag("is are was looks feels seems look feel")


_HUES = bag("blue red reddish redder")  # colours of light as well as tones of daylight
_LIGHTS = bag("lights lighting illumination leds neon glow")
_TINTS = bag("tint cast tinge hue undertone undertones tinges cast tints")
_PUTTING = bag("put add insert place stand hang move set bring install")
_NEUTRAL = 6500.0


@dataclass
class Heard:
    """What was understood of a clause so far.

    Attributes:
        fields: of the operation.
        anchored: whether it names light, a place or a time of day.
        pronoun: whether it says "it" for the scene.
        remark: whether it only says how the light is: "too dark".
    """

    fields: dict[str, Any] = field(default_factory=dict)
    anchored: bool = False
    pronoun: bool = False
    remark: bool = False


@dataclass
class _Pending:
    """What counts for the next change."""

    sign: int = 0
    degree: str = ""
    share: quantities.Quantity | None = None
    to: bool = False
    too: bool = False
    lack: bool = False
    denied: bool = False
    raised: int = 0

    def clear(self) -> None:
        self.sign, self.degree, self.share, self.to = 0, "", None, False
        self.too = self.lack = self.denied = False
        self.raised = 0


def read(words: Sequence[str], loose: bool = False) -> Heard | None:
    """What a clause says of light, None if it is not about light or a word is not understood.

    Args:
        words: in lower case, without marks.
        loose: whether "brighter" and "make it darker" mean the light: nothing else was spoken of, or light was.
    """
    if not words or not _may_ask(words):
        return None
    tokens = tokens_of(words)
    if tokens is None:
        return None
    heard = _Reading(tokens, loose).run()
    if heard is None or not heard.fields:
        return None
    if _states(words, tokens) and not heard.remark:
        return None
    return heard if heard.anchored or loose else None


def _may_ask(words: Sequence[str]) -> bool:
    if _NEVER & set(words) or _FORBIDDEN.search(" ".join(words)) or tuple(words[:2]) in _LIKING:
        return False
    about = len(words) > 1 and words[1] == "about"
    return about or (words[0] not in _QUESTIONS and words[0] != "how")


def _states(words: Sequence[str], tokens: Sequence[Token]) -> bool:
    """Whether a clause only says how things are: "the room is bright"."""
    first = next((i for i, (said, _) in enumerate(tokens) if said[-1] in _LINKS), None)
    return first is not None and not any(set(said) & _ASKS for said, _ in tokens)


class _Reading:
    """One pass over the tokens of a clause."""

    def __init__(self, tokens: Sequence[Token], loose: bool) -> None:
        self._tokens = tokens
        self._loose = loose
        self._heard = Heard()
        self._next = _Pending()
        self._noun = any("noun" in slots for _, slots in tokens)
        strong = any("mood" in slots and not needs_light(slots["mood"], said) for said, slots in tokens)
        self._air = strong or any(
            "air" in slots for said, slots in tokens if said[-1] not in ("feel", "look", "feeling")
        )
        self._place = any("place" in slots for _, slots in tokens)
        self._last: tuple[str, int] | None = None  # the change made last: field and sign
        self._weak = 0

    def run(self) -> Heard | None:
        for i, (said, slots) in enumerate(self._tokens):
            if not self._take(i, said, slots):
                return None
        if not self._close():
            return None
        heard = self._heard
        heard.anchored = heard.anchored or self._noun or self._place
        heard.pronoun = any("it" in slots for _, slots in self._tokens)
        return heard

    def _take(self, i: int, said: tuple[str, ...], slots: dict[str, Any]) -> bool:
        """Read one token; False if the clause cannot be about light."""
        following = self._tokens[i + 1][1] if i + 1 < len(self._tokens) else {}
        wait = self._next
        judged = wait.too or wait.lack or wait.denied or "enough" in following
        if "amount" in slots:
            wait.share = slots["amount"]
            wait.to = i > 0 and self._tokens[i - 1][0] in (("to",), ("at",))
            if self._belongs_before(i, following):
                fits = self._close()
                wait.clear()
                return fits
        elif "times" in slots:
            wait.share = quantities.Quantity("TIMES", slots["times"], "", 1)
        elif "kelvin" in slots:
            if said[0].isalpha():
                self._heard.fields.setdefault("kelvin", slots["kelvin"])
            else:
                self._heard.fields["kelvin"] = slots["kelvin"]
            self._heard.anchored = self._heard.anchored or not said[0].isalpha()
            self._last = None
        elif "side" in slots and (self._noun or self._air):
            self._heard.fields["side"] = slots["side"]
        elif "side" in slots:
            return False
        elif "mood" in slots and not (wait.too or wait.sign < 0) and not self._is_change(said, slots):
            return self._mood(said, slots["mood"])
        elif "not" in slots:
            wait.denied = True
        elif "lack" in slots:
            wait.lack = True
        elif ("too" in slots and ({"level", "color", "warmer"} & following.keys() or "degree" in following)) or (
            "too" in slots and "hard" in following
        ):
            wait.too = True
        elif "degree" in slots and "more" not in slots:
            wait.degree = slots["degree"]
        elif "more" in slots:
            wait.sign = slots["more"]
        elif "stop" in slots:
            return self._stops()
        elif "brighter" in slots and not ("level" in slots and self._linked()):
            self._expose(slots["brighter"] * (wait.sign or 1) * (-1 if wait.too or wait.denied else 1))
        elif "warmer" in slots:
            self._warm(slots["warmer"], judged)
        elif "color" in slots:
            return self._color(i, said, slots["color"])
        elif "hue" in slots:
            return self._hue(i, slots["hue"])
        elif "raise" in slots and (self._noun or {"contrast"} & self._slots()):
            wait.raised = slots["raise"]
        elif "contrast" in slots or "shadow" in slots or "harder" in slots or "hard" in slots:
            return self._contrast(slots)
        elif "flaw" in slots:
            self._heard.remark = True
            self._heard.anchored = True
            self._expose(slots["flaw"])
        elif "level" in slots and ("noun" not in slots or judged):
            return self._level(said, slots["level"], judged)
        elif "noun" in slots:
            self._about(following)
        elif "weak" in slots:
            self._weak = slots["weak"]
            self._lift_named(i, "amount" in following)
        return True

    def _lift_named(self, i: int, by: bool) -> None:
        """ "down" behind a word for light is its change: "the brightness down like 30 percent and warmer"."""
        named = any("noun" in slots for _, slots in self._tokens[:i])
        fresh = "exposure" not in self._heard.fields and not (self._next.sign or self._next.raised)
        if fresh and self._next.share is not None and self._next.share.kind == "TIMES":
            self._expose(self._weak)  # "two stops up"
        elif fresh and ((named and self._last is None) or (by and (named or self._loose))):
            self._expose(self._weak)

    def _belongs_before(self, i: int, following: dict[str, Any]) -> bool:
        """Whether an amount is of the change before it: "brighter by a third and warmer"."""
        if self._last is None or self._last[0] not in ("exposure", "warmth") or self._next.sign:
            return False
        coming = next((slots for _, slots in self._tokens[i + 1 :] if set(slots) != {"filler"}), {})
        if "stop" in coming:
            return False
        by = self._tokens[i - 1][0] == ("by",)
        return by or not {"brighter", "warmer", "more", "level", "color", "noun", "stop"} & following.keys()

    def _slots(self) -> set[str]:
        return {slot for _, slots in self._tokens for slot in slots}

    def _is_change(self, said: tuple[str, ...], slots: dict[str, Any]) -> bool:
        """Whether a word for a mood is a change here: "warm" of "warm light"."""
        return "warmer" in slots or ("color" in slots and bool(self._next.sign or self._next.too))

    def _mood(self, said: tuple[str, ...], mood: str) -> bool:
        feels = any(w[-1] in ("feel", "feeling") for w, _ in self._tokens)
        named = (
            self._noun
            or self._air
            or "shadow" in self._slots()
            or (feels and (self._place or "it" in self._slots()))
            or (
                self._loose and (self._next.sign > 0 or mood in _CONTRASTS or self._here())
            )  # "something more romantic"
        )
        if needs_light(mood, said) and not named:
            return False
        fields = self._heard.fields
        if mood in _CONTRASTS:
            fields["contrast"] = _CONTRASTS[mood]
            self._heard.anchored = True
            self._next.clear()
            return True
        if "mood" not in fields or needs_light(fields["mood"], ()):
            fields["mood"] = mood
        if self._next.degree:
            fields["amount"] = {"little": 0.6, "much": 1.4}[self._next.degree]
        self._heard.anchored = True
        self._next.clear()
        self._last = None
        return True

    def _here(self) -> bool:
        """Whether the clause is about where the speaker is: "make it cosy in here", not about furniture."""
        return any(said[-1] in ("here", "there") for said, slots in self._tokens if "place" in slots)

    def _expose(self, sign: int) -> None:
        wait = self._next
        self._heard.fields["exposure"] = _factor(sign, wait.degree, wait.share, wait.to)
        self._last = ("exposure", sign)
        wait.clear()

    def _warm(self, sign: int, judged: bool) -> None:
        wait = self._next
        disliked = self._linked() and (self._looks() or bool(wait.degree))  # "it looks a bit yellow"
        sign *= -1 if wait.sign < 0 or wait.too or disliked or (wait.denied and not wait.lack) else 1
        if disliked:
            wait.degree = ""
        if judged or disliked:
            self._heard.remark = True
        share = wait.share.value if wait.share is not None and wait.share.value <= 1 else None
        self._heard.fields["warmth"] = sign * (WARMTH[wait.degree] if share is None else share)
        self._last = ("warmth", sign)
        wait.clear()

    def _color(self, i: int, said: tuple[str, ...], sign: int) -> bool:
        """A colour of light: "less yellow", "too blue", "a golden glow"; a thing's colour otherwise."""
        wait = self._next
        compared = said[-1].endswith("er") and said[-1] not in ("amber",)
        disliked = self._linked() and (self._looks() or bool(wait.degree))
        if not (wait.sign or wait.too or compared or disliked):
            following = self._tokens[i + 1][1] if i + 1 < len(self._tokens) else {}
            before = self._tokens[i - 1][0][-1] if i else ""
            if said[-1] in _HUES and not self._heard.fields.get("color"):
                return self._hue(i, " ".join(said))
            plain = before in ("a", "an", "some", "with", "of", "in")
            if not (plain and "noun" in following):
                return False
        if not (self._noun or self._air or self._place or self._loose):
            return False
        if wait.sign > 0 and not (self._noun or self._air or self._place or compared):
            return False  # "a bit more blue" is said of a thing
        self._warm(sign, wait.too)
        return True

    def _hue(self, i: int, hue: str) -> bool:
        """Coloured light: "a blue light", "turn the lights purple"; what tints the light too much is taken out."""
        wait, tokens = self._next, self._tokens
        following = tokens[i + 1][1] if i + 1 < len(tokens) else {}
        before = tokens[i - 1][0][-1] if i else ""
        if wait.too or wait.sign or "air" in following:  # "too green", "a greenish tint"
            if not (self._noun or self._air or self._place or self._loose):
                return False
            if not (wait.too or wait.sign < 0 or any(said[-1] in _TINTS for said, _ in tokens)):
                return "air" in following and self._colored(hue)
            if hue in _HUES:
                wait.too = True
                self._warm(1 if hue.startswith("red") else -1, True)
                return True
            self._heard.remark = wait.sign >= 0
            self._heard.anchored = True
            self._heard.fields.setdefault("kelvin", _NEUTRAL)
            wait.clear()
            return True
        lights = any(said[-1] in _LIGHTS for said, _ in tokens[:i])
        placed = before in ("the", "that", "this", "my") or (before in ("a", "an") and self._puts())
        if "noun" in following and not placed:
            return self._colored(hue)
        return lights and (not following or "place" in following) and self._colored(hue)

    def _puts(self) -> bool:
        return any(said[0] in _PUTTING for said, _ in self._tokens)

    def _colored(self, hue: str) -> bool:
        self._heard.fields["color"] = hue
        self._heard.anchored = True
        self._last = None
        self._next.clear()
        return True

    def _contrast(self, slots: dict[str, Any]) -> bool:
        wait = self._next
        if not (self._noun or self._air or self._place or "contrast" in slots or "shadow" in slots):
            return False
        if "hard" in slots:
            self._heard.remark = wait.too
            if not (wait.too or wait.sign):
                return True
            sign = -1 if wait.too else wait.sign
        else:
            sign = slots.get("harder") or wait.sign or wait.raised
        if not sign:
            return "shadow" in slots  # "softer shadows"
        value = CONTRAST[wait.degree]
        self._heard.fields["contrast"] = round(value if sign > 0 else 1 / value, 3)
        self._heard.anchored = True
        self._last = ("contrast", sign)
        wait.clear()
        return True

    def _level(self, said: tuple[str, ...], level: int, judged: bool) -> bool:
        """ "dark", "bright": how it is, or how it is to be."""
        wait = self._next
        if judged:
            over = wait.too and not wait.denied
            sign = -level if over else level
            self._heard.remark = over or wait.lack or wait.denied
            wait.lack = wait.too = wait.denied = False
            self._expose(sign)
            return True
        if wait.sign:
            self._expose(level * wait.sign)
            return True
        if wait.share is not None:  # "twice as bright"
            factor = wait.share.value
            self._heard.fields["exposure"] = factor if level > 0 else 1 / max(factor, 0.05)
            wait.clear()
            return True
        if not (self._place or self._noun or self._loose):
            return False
        if self._linked():  # "the room looks gloomy"
            if not (wait.degree or self._looks() or said[-1] not in ("dark", "bright")):
                return False
            wait.degree, self._heard.remark = "", True
            self._expose(-level)
            return True
        wait.degree = wait.degree or "much"
        self._expose(level)
        return True

    def _linked(self) -> bool:
        """Whether the clause says how things are and asks for nothing."""
        words = [word for said, _ in self._tokens for word in said]
        return not _ASKS & set(words) and any(w in _LINKS for w in words)

    def _looks(self) -> bool:
        return any(said[-1] in ("looks", "feels", "seems", "look", "feel") for said, _ in self._tokens)

    def _about(self, following: dict[str, Any]) -> None:
        """A word for light: "more light", "raise the light", "half the light"."""
        wait = self._next
        if "noun" in following or {"kelvin", "side"} & following.keys():
            return
        if wait.lack:
            self._heard.remark = True
            wait.lack = False
            self._expose(1)
        elif wait.sign:
            self._expose(wait.sign)
        elif wait.raised:
            self._last = ("raised", wait.raised)
            self._expose(wait.raised)
        elif wait.share is not None and (wait.to or wait.share.kind in ("FRACTION", "TIMES")):
            self._heard.fields["exposure"] = wait.share.value
            wait.clear()

    def _stops(self) -> bool:
        wait = self._next
        count = wait.share.value if wait.share is not None else 1.0
        way = self._last[1] if self._last is not None else wait.sign or wait.raised or self._weak
        if count > 4:
            return False
        if not way:  # "a stop brighter"
            wait.share, self._heard.anchored = quantities.Quantity("TIMES", _STOP**count, "", 1), True
            return True
        self._heard.fields["exposure"] = _STOP ** (way * count)
        self._heard.anchored = True
        wait.clear()
        return True

    def _close(self) -> bool:
        """Give what is left over to the last change."""
        wait, fields = self._next, self._heard.fields
        if wait.too or wait.lack or wait.denied:
            return False
        if self._weak and self._noun and not fields:
            self._expose(self._weak)
        if wait.raised and not fields and self._noun:
            self._expose(wait.raised)
        if wait.share is not None and wait.to and self._last is None and self._noun and not fields:
            fields["exposure"] = wait.share.value  # "set the brightness to 40%"
            return 0.02 <= wait.share.value <= 20
        if wait.share is not None or wait.degree:
            if self._last is None or self._last[0] not in ("exposure", "warmth", "contrast"):
                return wait.share is None
            name, sign = self._last
            if name == "exposure":
                fields[name] = _factor(sign, wait.degree, wait.share, wait.to)
            elif name == "warmth":
                fields[name] = sign * (WARMTH[wait.degree] if wait.share is None else min(wait.share.value, 1.0))
            elif wait.degree:
                value = CONTRAST[wait.degree]
                fields[name] = round(value if sign > 0 else 1 / value, 3)
        return True


def _factor(sign: int, degree: str, share: quantities.Quantity | None, to: bool) -> float:
    """The factor of exposure for a change, or the one that is said."""
    if share is None:
        return (UP if sign > 0 else DOWN)[degree]
    if to or share.kind == "TIMES":
        value = share.value if to or sign > 0 else 1 / max(share.value, 0.05)
    else:
        value = 1 + share.value if sign > 0 else 1 - share.value
    return round(min(max(value, 0.02), 20.0), 4)


__all__ = ["Heard", "Meaning", "read"]
