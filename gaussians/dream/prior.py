"""What a prompt says of an object before anything is dreamt: its kind, its size, and a form to start from."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import torch

from ..assets.modeling import imported
from ..assets.modeling.make import make
from ..cloud import GaussianCloud
from ..color import known
from ..errors import UserError
from ..scene import Frame, Scene
from ..world import kinds
from .start import Start, form, sphere

_FRAME = Frame(floor=0.0, metres_per_unit=1.0, up_source="given", scale_source="given")
UNKNOWN = 1.0  # metres: the longest side of what is of no known kind
_CLAUSE = re.compile(r",| with | made of | that | on a | on the | in a | in the ", re.IGNORECASE)


def kind_of(prompt: str) -> kinds.Kind | None:
    """The kind that a prompt names: "a red armchair with wooden legs" is an armchair."""
    return kinds.of(_CLAUSE.split(prompt.strip())[0])


def start_for(spec: str, prompt: str, most: int, rng: np.random.Generator, seed: int = 0) -> tuple[Start, str]:
    """The Gaussians to dream from, and what they are in words.

    Args:
        spec: "auto" (a library thing of the prompt's kind, otherwise a sphere), "sphere", "procedural", or the path of
            a mesh or of Gaussians (.glb, .ply).
        most: Gaussians.

    Raises:
        UserError: "procedural" and the library draws nothing of that kind.
        FileError: a file cannot be read.
    """
    if spec == "sphere":
        return sphere(rng, min(most, 4_000)), "a sphere"
    if spec in ("auto", "procedural"):
        kind = kind_of(prompt)
        if kind is not None and kind.asset:
            return form(library_thing(prompt, seed).cloud, most, rng), f"the library's {kind.asset}"
        if spec == "auto":
            return sphere(rng, min(most, 4_000)), "a sphere"
        what = f"the library draws no {kind.name}" if kind is not None else f"no kind of thing is named in {prompt!r}"
        raise UserError(f"{what}; use --from sphere, or a mesh to start from (--from FILE.glb)")
    path = Path(spec)
    return form(imported.read(path, imported.natural_size(path), "object").cloud, most, rng), path.name


def library_thing(prompt: str, seed: int = 0) -> Scene:
    """The library's nearest thing, in the colour that the prompt says, if it says one.

    Raises:
        UserError: the library draws nothing of that kind.
    """
    kind = kind_of(prompt)
    if kind is None or not kind.asset:
        raise UserError(f"the library draws nothing like {prompt!r}")
    color = next((w for w in re.findall(r"[a-z]+", prompt.lower()) if known(w) is not None), None)
    return Scene(make(kind.asset, seed, color=color).cloud, frame=_FRAME)


def standing(cloud: GaussianCloud, prompt: str, height: float | None = None) -> Scene:
    """A dreamt object as a scene: it stands on z = 0, centred, in metres, its front towards -y.

    Args:
        height: metres; None: that of its kind as sold, or a longest side of a metre for what is of no known kind.
    """
    points = cloud.means.to(torch.float64).numpy()
    low, high = np.quantile(points, [0.005, 0.995], axis=0)
    longest = max(float((high - low).max()), 1e-30)
    factor = _longest(prompt) / longest if height is None else height / max(float(high[2] - low[2]), 1e-3 * longest)
    foot = torch.from_numpy(np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]]).astype(np.float32))
    placed = cloud.replace(means=(cloud.means - foot) * factor, scales=cloud.scales * factor)
    return Scene(placed, frame=_FRAME)


def _longest(prompt: str) -> float:
    """The longest side of a thing of its kind as sold, metres."""
    kind = kind_of(prompt)
    return UNKNOWN if kind is None else max(kind.usual_size)
