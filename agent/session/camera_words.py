"""Reads words that move the camera: "look from the left", "closer", "orbit", "from above", "look at the chair".

Nothing here looks at a scene. What names no move of the camera gives None, so that it can be an instruction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ...gaussians import late_re as re
from .answers import plain

Kind = Literal["side", "nearer", "orbit", "turn", "home", "thing"]


@dataclass(frozen=True)
class CameraMove:
    """One move of the camera.

    Attributes:
        kind: "side": look from a side; "nearer": closer or farther; "orbit": around what is seen; "turn": on the spot;
            "home": back to the first view; "thing": look at a thing.
        side: of "side": "front", "behind", "left", "right", "above", "below".
        share: of "nearer": the new distance, of the present one.
        azimuth: of "orbit" (counter-clockwise from above) and "turn" (to the left), degrees.
        upward: of "orbit" and "turn", degrees.
        words: the noun phrase of the thing that it is about, "" if none; of "thing" with its side, "the chair from
            behind".
        bare: whether the words could also go on with an edit ("closer", after a chair was moved).
    """

    kind: Kind
    side: str = ""
    share: float = 1.0
    azimuth: float = 0.0
    upward: float = 0.0
    words: str = ""
    bare: bool = False


STEP = 45.0  # degrees of an orbit
TURN = 25.0  # degrees of a turn on the spot
RISE = 15.0  # degrees by which the camera rises around what it sees
LITTLE, PLAIN, MUCH = 0.8, 0.6, 0.35  # shares of the distance that remain

_SIDES = {
    "front": r"front", "behind": r"behind|back|rear|other side|opposite side", "left": r"left", "right": r"right",
    "above": r"above|top|overhead|high up|bird'?s[- ]eye view|ceiling", "below": r"below|underneath|under|bottom",
}  # fmt: skip
_SIDE = "|".join(f"(?P<{name}>{words})" for name, words in _SIDES.items())
_CAMERA = r"(?:the |my )?(?:camera|view|viewpoint|viewer)"
_LOOK = (
    rf"(?:(?:look|view|see|watch|show(?: me| us)?|move|go|turn|set|put|{_CAMERA}|a view|the view|it|everything"
    r"|(?:the |this )?(?:whole )?(?:scene|room)|at|now|and|a picture)\s+)*"
)
_FROM = re.compile(rf"{_LOOK}from (?:the |a )?(?:{_SIDE})(?: side| hand side)?(?: of (?:it|the scene|the room))?")
_VIEW = re.compile(rf"{_LOOK}(?:the |a )?(?:{_SIDE}|bird'?s[- ]eye)[- ]view(?: of (?:it|the scene|the room))?")
_THING_SIDE = re.compile(
    r"(?:look|see|view|show(?: me| us)?)(?: at)? (?P<thing>(?:the|this|that|it|my|a) ?.*?) (?P<side>from (?:the )?"
    rf"(?:{'|'.join(_SIDES.values())})(?: side)?)"
)
_SIDE_THING = re.compile(
    rf"(?:look|see|view) (?P<side>from (?:the )?(?:{'|'.join(_SIDES.values())})(?: side)?) at (?P<thing>.+)"
)
_AT = re.compile(r"(?:look|zoom in|close in|point the camera) (?:at|on|to(?:wards)?) (?P<thing>.+)")
_MORE = (
    r"(?:(?P<little>(?:just )?(?:a )?(?:bit|little|tad)(?: more)?|slightly|somewhat)|(?P<much>much|a lot|way|far|lots))"
)
_MORE_AFTER = _MORE.replace("<little>", "<little2>").replace("<much>", "<much2>")
_IN = r"closer|nearer|in|forwards?|closer in|up close"
_OUT = r"farther|further|out|backwards?|(?:farther|further) (?:away|out|off|back)|away|back"
_NEARER = re.compile(
    rf"(?P<verb>(?:go|come|move|get|step|walk|zoom|dolly|pull|{_CAMERA}|move {_CAMERA}|bring {_CAMERA})\s+)?"
    rf"(?:{_MORE}\s+)?(?:(?P<near>{_IN})|(?P<far>{_OUT}))(?: {_MORE_AFTER})?"
    r"(?: to (?:it|(?P<thing>the .+)))?"
)
_DEGREES = r"(?: (?:by )?(?P<degrees>\d{1,3}(?:\.\d+)?) ?(?:degrees?|deg|°))?"
_WAY = r"(?: (?:(?:to|towards) the )?(?P<way>left|right|clockwise|counter-?clockwise|anti-?clockwise))?"
_ORBIT = re.compile(
    rf"(?:orbit|circle|(?:go|walk|move|fly|turn|swing) (?:a?round)|(?:orbit|rotate|turn|swing|move) {_CAMERA} around"
    rf"|rotate {_CAMERA})(?: a?round)?(?: (?P<thing>it|the (?!left|right|camera|view).+?))?"
    rf"{_WAY}{_DEGREES}{_WAY.replace('way', 'way2')}"
)
_TURN = re.compile(
    rf"(?:look|pan|tilt|(?:turn|pan|tilt|point) {_CAMERA}) (?:{_MORE} )?(?:more )?(?:to(?:wards)? the )?"
    rf"(?P<way>left|right|up|down|upwards?|downwards?){_DEGREES}(?: {_MORE_AFTER})?"
)
_RISE = re.compile(
    rf"(?:(?:go|move {_CAMERA}|{_CAMERA}|get) (?:{_MORE} )?(?P<way>higher|lower|up|down)"
    rf"|(?P<verb>raise|lower|lift) {_CAMERA})"
)
_HOME = re.compile(
    rf"(?:reset|restore) {_CAMERA}"
    r"|(?:go |look )?(?:back )?(?:to )?the (?:first|original|initial|starting|start|default) view"
    r"|(?:go )?back to the (?:start|beginning)|home view|first view"
)
_POLITE = re.compile(r"^(?:please|now|ok|okay|and|then|can you|could you|let'?s|let me|i want to)\s+|\s+please$")
_PARTS = re.compile(r",? and (?:then )?|, (?:then )?|; | then ")
_LONGEST = 200  # characters


def read_moves(text: str) -> tuple[CameraMove, ...] | None:
    """The moves of the camera that a text asks for, in order; None if any part of it asks for something else."""
    said = plain(text)
    if len(said) > _LONGEST:
        return None
    while (shorter := _POLITE.sub("", said)) != said:
        said = shorter
    if (whole := _move(said)) is not None:
        return (whole,)
    moves = [_move(_POLITE.sub("", part.strip())) for part in _PARTS.split(said)]
    return tuple(m for m in moves if m is not None) if len(moves) > 1 and None not in moves else None


def _move(said: str) -> CameraMove | None:
    if _HOME.fullmatch(said):
        return CameraMove("home")
    readings = (reader(said) for reader in (_side, _rise, _turn, _orbit, _nearer, _thing))
    return next((move for move in readings if move is not None), None)


def _side(said: str) -> CameraMove | None:
    match = _FROM.fullmatch(said) or _VIEW.fullmatch(said)
    if match is None:
        return None
    return CameraMove("side", side=next((s for s in _SIDES if match[s]), "above"))


def _rise(said: str) -> CameraMove | None:
    match = _RISE.fullmatch(said)
    if match is None:
        return None
    down = match["way"] in ("lower", "down") or match["verb"] == "lower"
    return CameraMove("orbit", upward=-RISE if down else RISE)


def _turn(said: str) -> CameraMove | None:
    match = _TURN.fullmatch(said)
    if match is None:
        return None
    by = float(match["degrees"]) if match["degrees"] else TURN * _amount(match)
    way = match["way"].removesuffix("s").removesuffix("ward")
    across, upward = {"left": (by, 0.0), "right": (-by, 0.0), "up": (0.0, by)}.get(way, (0.0, -by))
    return CameraMove("turn", azimuth=across, upward=upward)


def _orbit(said: str) -> CameraMove | None:
    match = _ORBIT.fullmatch(said)
    if match is None:
        return None
    by = float(match["degrees"]) if match["degrees"] else STEP
    way = match["way"] or match["way2"] or "right"
    thing = match["thing"] or ""
    return CameraMove(
        "orbit", azimuth=-by if way in ("left", "clockwise") else by, words="" if thing == "it" else thing
    )


def _nearer(said: str) -> CameraMove | None:
    match = _NEARER.fullmatch(said)
    if match is None or (not match["verb"] and said in ("in", "out", "away", "back", "forward", "backward")):
        return None
    little, much = match["little"] or match["little2"], match["much"] or match["much2"]
    share = LITTLE if little else MUCH if much else PLAIN
    near = match["near"] is not None
    return CameraMove("nearer", share=share if near else 1 / share, words=match["thing"] or "", bare=not match["verb"])


def _thing(said: str) -> CameraMove | None:
    match = _THING_SIDE.fullmatch(said) or _SIDE_THING.fullmatch(said)
    if match is not None:
        return CameraMove("thing", words=f"{match['thing']} {match['side']}")
    if (match := _AT.fullmatch(said)) is None:
        return None
    close = " close up" if said.startswith(("zoom", "close")) else ""
    return CameraMove("thing", words=match["thing"] + close)


def _amount(match: re.Match[str]) -> float:
    """A factor for "a bit" and "much"."""
    if match["little"] or match["little2"]:
        return 0.5
    return 2.0 if match["much"] or match["much2"] else 1.0
