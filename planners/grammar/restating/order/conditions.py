"""Detects conditions on the state of the scene: "if the bench is red, delete it".

Plans hold no conditions, so an instruction with one is refused: without its condition it would be another instruction.
"If you can", "if there is room" and "if the bench is too wide" are courtesy or a reason, and no conditions here.
"""

from __future__ import annotations

from collections.abc import Sequence

from .....gaussians import late_re as re
from ...tagging.lookahead import Lookahead, color_at
from ..chunks import is_thing

_LEADING = re.compile(
    r"^(?:(?:and|then|but|please|also) )*(?P<word>if|unless) (?P<thing>[^,]+?) (?:is|are|'s) (?P<state>[^,]+?) , \S"
)
_ROOM = re.compile(r"^(?:any |enough |some |still |no )*(?:room|space|time|need|place|way|chance)\b")


def has_condition(said: Sequence[str]) -> bool:
    """Whether a sentence begins with a condition on what the scene holds, or on the colour or place of a thing."""
    found = _LEADING.match(" ".join(said))
    if found is None:
        return False
    if found["thing"] == "there":
        return _ROOM.match(found["state"]) is None
    state = found["state"].removeprefix("not ").split()
    checked = found["word"] == "unless" or color_at(state, 0) is not None or bool(Lookahead(state).preposition_at(0))
    return checked and is_thing(tuple(found["thing"].split()))
