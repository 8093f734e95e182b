"""Whether a lamp is on or off at a time, by how bright it looks then beside other times: "is the lamp off at 3 s?".

A lamp that always looks alike tells nothing: whether it is lit is for a picture to tell.
"""

from __future__ import annotations

import torch

from .....gaussians import late_re as re
from .....gaussians.color import LUMA
from .....gaussians.harmonics import SH_C0
from .....gaussians.motion.holding import joined
from ....grammar.lighting.lamps import is_lamp
from ...answer import Answer
from ...timeline.asked import Told, at, spoken, yes_no
from ...timeline.bodies import Body
from ...timeline.worn import ids_of, recoloring

_STATE = re.compile(r"^(?:is|are|was|were) .+? (?:(?:switched|turned) )?(?P<state>off|on|out|unlit|lit)\b")
_OFF = frozenset({"off", "out", "unlit"})
_DARKER = 0.9  # of its greatest brightness: a lamp that is darker is off
_SURE = 0.7  # probability that a lamp that is darker for a while is off, and not dimmed
_ONE = 1e-3  # seconds between two times of a lamp that are one


def state_asked(told: Told) -> str:
    """Whether a question is if a lamp is "on" or "off", as it is said; "" if it is none of these, as if it moves."""
    what = told.frame.what
    named = what.subject is not None and is_lamp(what.subject.text)
    state = _STATE.match(told.asked.said) if named and what.object is None and not what.at else None
    return "" if state is None else state["state"]


def is_lit(told: Told, state: str) -> Answer | None:
    """Whether a lamp is on, or off, at the time that is asked of; None if no time is, or its light never changes.

    Args:
        state: as it is said.
    """
    if (window := told.window()) is None:
        return None
    body, time = told.one(), window[1]
    levels = _brightness(told, body)
    brightest = max(level for *_, level in levels)
    dark = joined([(a, b) for a, b, level in levels if level < _DARKER * brightest], _ONE)
    if not dark:
        return None
    off = any(a <= time < b or time == b == told.timeline.stop for a, b in dark)
    is_so = f"{body.name} is darker than at other times" if off else f"{body.name} is as bright as ever"
    text = f"{is_so} at {at(time)}: it is darker {spoken(dark)}."
    given = yes_no(off == (state in _OFF), text, [body], time)  # "is it not off" has "yes" where it is off
    return given.model_copy(update={"confidence": _SURE})


def _brightness(told: Told, body: Body) -> list[tuple[float, float, float]]:
    """The mean luminance of a lamp between any two changes of its look: from, to (seconds) and level."""
    line, cloud = told.timeline, told.timeline.scene.cloud
    looks = recoloring(line, body.group.id)
    cuts = sorted({line.start, line.stop, *(t for k in looks for t in (k.start, k.stop) if line.start < t < line.stop)})
    ids = torch.from_numpy(ids_of(line, body.group.id))
    own = _luminance(cloud.sh[torch.isin(cloud.ids.cpu(), ids)])
    levels = [own] * (len(cuts) - 1)
    for look in looks:
        assert look.sh is not None
        level = _luminance(look.sh[torch.isin(torch.as_tensor(look.ids).cpu(), ids)])
        levels = [level if look.lasts_at(a) else old for a, old in zip(cuts, levels, strict=False)]
    return list(zip(cuts, cuts[1:], levels, strict=False))


def _luminance(sh: torch.Tensor) -> float:
    """The mean luminance of Gaussians by the constant term of their harmonics `[n, K, 3]`."""
    return float((sh[:, 0].float().cpu() * SH_C0 + 0.5).mean(dim=0) @ torch.tensor(LUMA))
