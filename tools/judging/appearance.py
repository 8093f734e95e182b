"""Checks of what is seen: things are rendered alone from the cloud and shown to the embedded encoder again."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...gaussians.cloud import GaussianCloud
from ...gaussians.color import rgb_to_lab
from ...gaussians.language.encoders.probability import probability
from ...gaussians.language.field.measure import box_of
from ...gaussians.language.query.attributes import color_scores
from ...gaussians.language.query.color.fallback import is_reliable
from ...gaussians.language.query.query import ALL, BACKGROUND, FLOATERS, Query
from ...gaussians.language.query.terms import ANYTHING, STRUCTURE
from ...gaussians.language.segmentation.group_renders import mean_vectors
from ...gaussians.scene import Frame, Scene
from ...gaussians.world.compounds import split
from ..coloring.seen import middle_of, seen_pixels
from ..receipt import Check, at_least, report

if TYPE_CHECKING:
    from ...gaussians.language.encoders import Encoder

VIEWS = 2  # renders of each thing
MOST = 4  # things that are looked at in one operation
LOOKS = 0.04  # probability below which a thing is not what it was called
PIXELS = 96  # side of the pictures in which colours are measured
COLOR_SEEN = 0.1  # score from which seen pixels may have the asked colour: half of the way to the next colour word


def embedded() -> Encoder:
    """The encoder that is shipped with the package, whatever encoder the scene was embedded with."""
    from ...gaussians.language import encoders

    return encoders.load()


def is_looked_for(query: Query, encoder: Encoder) -> bool:
    """Whether the query names a kind of thing that the encoder knows, and nothing else decides what it means: no person
    has confirmed it, for one."""
    word = query.text.lower()
    fixed = query.last or query.groups or query.confirmed or query.invert or query.also or query.pick == "rest"
    part = any(r.name == "part_of" for r in query.relations) or split(word) is not None  # "table top"
    unnamed = word in ANYTHING | ALL | BACKGROUND | FLOATERS or word in STRUCTURE
    return not (fixed or part or unnamed) and encoder.knows(word)


def is_judge_of(encoder: Encoder, scene: Scene) -> bool:
    """Whether the encoder's word counts in a scene: it was embedded by it, and most of its things have a sure label."""
    field = scene.language
    return field is not None and field.encoder == encoder.fingerprint and is_reliable(field)


def likeness(encoder: Encoder, word: str, clouds: Sequence[GaussianCloud], scene: Scene) -> NDArray[np.float64]:
    """`[len(clouds)]` probability that each cloud is a `word`, from renders of it alone and its size."""
    vectors = mean_vectors(encoder, clouds, scene.frame, middle_of(scene), VIEWS)
    return probability(encoder, word, vectors, _sizes(clouds, scene.frame))


def _sizes(clouds: Sequence[GaussianCloud], frame: Frame) -> NDArray[np.float64]:
    """`[C, 3]` extents in metres; NaN where the scale is unknown."""
    scale = frame.metres_per_unit or float("nan")
    return np.array([box_of(c, frame).size for c in clouds]).reshape(-1, 3) * scale


def looks_as_named(name: str, word: str, encoder: Encoder, clouds: Sequence[GaussianCloud], scene: Scene) -> Check:
    """The encoder, shown these things anew, finds them to be a `word`; the least probable of them counts."""
    known = [c for c in clouds if len(c)][:MOST]
    if not known:
        return at_least(name, 0.0, LOOKS, "1", f"nothing is there that could be a {word}")
    least = float(likeness(encoder, word, known, scene).min())
    return at_least(name, least, LOOKS, "1", f"the encoder finds it to be a {word} with probability {least:.2f}")


def seen_lab(cloud: GaussianCloud, scene: Scene) -> NDArray[np.float64]:
    """`[P, 3]` Lab of the pixels that show a cloud rendered alone."""
    return rgb_to_lab(seen_pixels(cloud, scene, VIEWS, PIXELS)).numpy()


def lit(lab: NDArray[np.float64]) -> NDArray[np.float64]:
    """`[3]` colour of the lit pixels among `[P, 3]`: medians of a and b, the 80th percentile of lightness."""
    return np.array([np.quantile(lab[:, 0], 0.8), np.median(lab[:, 1]), np.median(lab[:, 2])])


def looks_colored(name: str, word: str, cloud: GaussianCloud, scene: Scene, least: float = COLOR_SEEN) -> Check:
    """The pixels that show a thing have the colour `word`.

    The best of three measures counts: the lit pixels, the mean pixel, and the share of the pixels of that colour.
    """
    lab = seen_lab(cloud, scene)
    if len(lab) < 4:
        return report(name, 0.0, "1", "too few of its pixels are solid to see a colour")
    scores = [float(color_scores(word, lit(lab))), float(color_scores(word, lab.mean(axis=0)))]
    scores.append(float((color_scores(word, lab) >= 0.5).mean()))
    best = max(scores)
    return at_least(name, best, least, "1", f"its pixels fit the colour {word} with a score of {best:.2f}")
