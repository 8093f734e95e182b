"""Checks of hues: a new colour has the asked one, more or less light changes none, and copies look like originals."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ...gaussians.cloud import GaussianCloud
from ...gaussians.color import rgb_to_lab, shade_of
from ...gaussians.language.field.measure import mean_lab, sample
from ...gaussians.scene import Scene
from ..coloring.scene_light import scene_light
from ..coloring.seen import few_of, lit_face, seen_colors
from ..ops.recolor import Recolor
from ..receipt import Check, at_least, at_most, report
from .appearance import seen_lab
from .case import Case

_HUE = 6.0  # Lab distance in a and b by which a hue may be off; of clean edits it is below 2
_CHROMA = (0.5, 1.4)  # times the asked chroma: what counts as the same hue, paler or purer
_TYPICAL, _MOST = 2.0, 5.0  # the same under more or less light: of half and of nine in ten of the pixels
_GREY, _PALER, _PURER = 10.0, 0.7, 1.3  # chroma above which it is kept, and times which; greys may lose theirs
_NEW, _PART = 12.0, 0.05  # the same of a pixel of a new thing, and the least share of them that have the hue
_LIKE = 4.0  # Lab distance of the mean colour of a copy from that of the original
_DARK = 12.0  # Lab lightness of a pixel from which a hue is seen
_FEW = 16  # pixels or Gaussians


def as_asked(case: Case, op: Recolor, rows: Tensor) -> tuple[Check, ...]:
    """The hue of the lit faces of what was painted, `rows` `[M]` of the cloud before, is that of the asked colour."""
    if len(case.now(rows)) < _FEW:
        return ()
    was, now = seen_colors(case.before, rows), lit_face(seen_colors(case.after, case.now(rows)))[1:]
    asked = rgb_to_lab(op.aim(case.before.cloud, rows, was, scene_light(case.before.cloud)))[1:]
    share = float((now @ asked) / (asked @ asked).clamp(min=1e-9))
    off = float(torch.linalg.vector_norm(now - min(max(share, _CHROMA[0]), _CHROMA[1]) * asked))
    said = f"its hue is {off:.1f} from that of {op.color} in this light"
    return (at_most("hue as asked", off, _HUE, "ΔE", said),)


def new_in_color(name: str, color: str, cloud: GaussianCloud, scene: Scene) -> Check:
    """A part of a new thing has the hue of a colour: assets paint some of their parts with it."""
    asked = rgb_to_lab(torch.tensor(shade_of(color), dtype=torch.float64)).numpy()[1:]
    seen = seen_lab(cloud, scene)
    if len(seen) < _FEW:
        return report(name, 0.0, "1", "too few of its pixels are solid to see a hue")
    along = np.clip(seen[:, 1:] @ asked / max(float(asked @ asked), 1e-9), *_CHROMA)
    share = float((np.linalg.norm(seen[:, 1:] - along[:, None] * asked, axis=1) <= _NEW).mean())
    return at_least(name, share, _PART, "1", f"{share:.0%} of its pixels have the hue of {color}")


def kept_in_light(case: Case, rows: Tensor) -> tuple[Check, ...]:
    """Under more or less light every colour keeps its hue; rows `[M]` of the cloud before.

    Light scales a and b of CIELAB with L + 16, and a colour may become paler near white.
    """
    if len(case.now(rows)) < _FEW:
        return ()
    was, now = (
        seen_lab(few_of(scene.cloud, of), scene) for scene, of in ((case.before, rows), (case.after, case.now(rows)))
    )
    if len(was) != len(now) or len(was) < _FEW:
        return (report("hue kept", 0.0, "ΔE", "too few of its pixels are solid to see a hue"),)
    seen = (was[:, 0] > _DARK) & (now[:, 0] > _DARK)
    if seen.sum() < _FEW:
        return (report("hue kept", 0.0, "ΔE", "it is too dark to see a hue"),)
    off = _off_hue(was[seen], now[seen])
    typical, most = float(np.median(off)), float(np.quantile(off, 0.9))
    said = f"hues of its pixels shifted by {typical:.1f}, in nine of ten by less than {most:.1f}"
    return (at_most("hue kept", max(typical / _TYPICAL, most / _MOST), 1.0, "of what may be seen", said),)


def _off_hue(was: NDArray[np.float64], now: NDArray[np.float64]) -> NDArray[np.float64]:
    """`[P]` distance in a and b of pixels from their colours before under another light."""
    expected = was[:, 1:] * ((now[:, :1] + 16) / (was[:, :1] + 16))
    along = (now[:, 1:] * expected).sum(axis=1) / np.maximum((expected**2).sum(axis=1), 1e-12)
    least = np.where(np.linalg.norm(was[:, 1:], axis=1) > _GREY, _PALER, 0.0)
    kept = np.clip(along, least, _PURER)
    off: NDArray[np.float64] = np.linalg.norm(now[:, 1:] - kept[:, None] * expected, axis=1)
    return off


def like_original(case: Case, copy: Tensor, original: Tensor) -> Check:
    """The mean colour of a copy, rows of the cloud after, is that of the original, rows of the cloud before."""
    was, now = mean_lab(sample(case.before.cloud, original)), mean_lab(sample(case.after.cloud, copy))
    off = float(torch.linalg.vector_norm(was - now))
    return at_most("coloured as the original", off, _LIKE, "ΔE", f"its colour is {off:.1f} from that of the original")
