"""`budget`: what each part of a scene's model takes in bytes, and what pictures and names lose if it is dropped.

The parts are SH bands, Gaussians by what they show, things, the views that they are seen from, and the language field
with the dimensions of its vectors. Every loss is measured: the part is dropped and the scene is rendered, or named.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Literal

import numpy as np
import torch
from numpy.typing import NDArray

from ..camera import Camera
from ..cloud import GaussianCloud
from ..errors import BackendError
from ..language.encoders import Encoder
from ..language.field.group_index import index_groups
from ..language.field.group_table import named
from ..language.field.language_field import LanguageField
from ..render import contributions
from ..scene import Frame, Scene
from .importance import Importance, Progress, measure
from .loss import Truth
from .reductions import made_up
from .report import inria_bytes
from .views import SIZE, View, choose_views

SHARES = (0.1, 0.25, 0.5, 0.75, 0.9)  # of the Gaussians that are dropped, those that show least first
MOST_THINGS = 10  # things of which each is dropped
SEEN = 0.01  # summed blending weight, in pixels, from which a view shows a Gaussian
COVERS = (0.9, 0.99, 1.0)  # shares of the Gaussians that views show
DIMENSIONS = (64, 32, 16, 8)  # of vectors
FLOAT = 4  # bytes

Part = Literal["harmonics", "gaussians", "thing", "views", "vectors", "field"]


@dataclass(frozen=True)
class Row:
    """One part of a model that could be dropped.

    Attributes:
        part: what kind of part.
        what: the part in words.
        bytes: that it takes: as INRIA .ply, or in memory for a language field.
        share: of the bytes of the whole scene or field.
        psnr: dB that pictures keep without it; None if no picture changes.
        kept: share of the names, or of the Gaussians seen, that stays without it; None if it is not about these.
    """

    part: Part
    what: str
    bytes: int
    share: float
    psnr: float | None = None
    kept: float | None = None


@dataclass(frozen=True)
class Budget:
    """The parts of a scene's model.

    Attributes:
        gaussians, bytes: of the whole scene as INRIA .ply.
        rows: the parts.
        unseen: share of the Gaussians that no view shows.
        field_bits: bits a Gaussian of the language field, by column; empty without a field.
        vector_bits: bits a Gaussian if each stored its own vector; 0 without a field.
        views: number of views, and where they come from.
        cameras: where the views come from.
    """

    gaussians: int
    bytes: int
    rows: tuple[Row, ...]
    unseen: float
    field_bits: dict[str, float]
    vector_bits: float
    views: int
    cameras: str


def budget(
    scene: Scene,
    cameras: Sequence[Camera] = (),
    encoder: Encoder | None = None,
    size: int = SIZE,
    progress: Progress | None = None,
) -> Budget:
    """Measure what each part of a scene buys.

    Args:
        cameras: of photographs of the scene; without them views are computed.
        encoder: the encoder of the language field, to name the things again with shorter vectors; None leaves that out.
        size: pixels of the longer side of the views.
        progress: called with the stage and its share.

    Raises:
        UserError: no view shows anything of the scene.
    """
    say = progress or (lambda stage, share: None)
    chosen = choose_views(scene, cameras, size)
    views = chosen.choice
    truth, importance = Truth(scene.cloud, views), measure(scene.cloud, views)
    seen = _seen(scene.cloud, views)
    stages: dict[str, Callable[[], list[Row]]] = {
        "harmonics": lambda: _harmonics(scene.cloud, importance, truth),
        "gaussians": lambda: _gaussians(scene.cloud, importance, truth),
        "things": lambda: _things(scene, importance, truth),
        "views": lambda: _views(scene.cloud, seen),
        "vectors": lambda: _vectors(scene, encoder),
    }
    rows: list[Row] = []
    for number, (name, found) in enumerate(stages.items()):
        say(name, number / len(stages))
        rows += found()
    bits = field_bits(scene)
    vector = 8.0 * FLOAT * scene.language.embeddings.shape[1] if scene.language is not None else 0.0
    return Budget(
        len(scene.cloud), inria_bytes(scene.cloud), tuple(rows), float(1 - seen.any(axis=0).mean()), bits, vector,
        len(views), chosen.source,
    )  # fmt: skip


def field_bits(scene: Scene) -> dict[str, float]:
    """Bits a Gaussian of a scene's language field by column: "groups", the number of each Gaussian's group; "vectors"
    and "table", which are of groups, divided by the number of Gaussians; empty without a field."""
    if scene.language is None:
        return {}
    table = len(json.dumps([asdict(g) for g in scene.language.groups]))
    count = max(len(scene.cloud), 1)
    return {
        "groups": 8.0 * scene.cloud.group.element_size(),
        "vectors": 8.0 * FLOAT * scene.language.embeddings.size / count,
        "table": 8.0 * table / count,
    }


def _harmonics(cloud: GaussianCloud, importance: Importance, truth: Truth) -> list[Row]:
    whole, rows = inria_bytes(cloud), list[Row]()
    for degree in range(cloud.degree - 1, -1, -1):
        sh = cloud.sh.numpy()
        fewer = cloud.replace(sh=torch.from_numpy(made_up(sh, sh[:, 1 : (degree + 1) ** 2], importance)))
        saved = whole - inria_bytes(fewer)
        what = f"bands above degree {degree}, their mean colour kept"
        rows.append(Row("harmonics", what, saved, saved / whole, truth.loss(fewer).psnr))
    return rows


def _gaussians(cloud: GaussianCloud, importance: Importance, truth: Truth) -> list[Row]:
    order, whole, rows = np.argsort(importance.removal, kind="stable"), inria_bytes(cloud), list[Row]()
    for share in SHARES:
        dropped = round(share * len(order))
        if 0 < dropped < len(order):
            kept = cloud[torch.from_numpy(np.sort(order[dropped:]))]
            what = f"{dropped:,} Gaussians that show least"
            rows.append(Row("gaussians", what, whole - inria_bytes(kept), dropped / len(order), truth.loss(kept).psnr))
    return rows


def _things(scene: Scene, importance: Importance, truth: Truth) -> list[Row]:
    """The things with most Gaussians, each dropped alone, and how many of its Gaussians show little."""
    if scene.language is None:
        return []
    members, whole = index_groups(scene.cloud), inria_bytes(scene.cloud)
    weak = importance.removal < np.median(importance.removal)
    things = sorted((g for g in scene.language.groups if g.parent < 0 and g.count), key=lambda g: (-g.count, g.id))
    rows = []
    for group in things[:MOST_THINGS]:
        own = members.rows(scene.language.leaves(group.id))
        rest = torch.ones(len(scene.cloud), dtype=torch.bool)
        rest[torch.from_numpy(own)] = False
        if not len(own) or not bool(rest.any()):
            continue
        share = len(own) / len(scene.cloud)
        what = f"{group.label or 'unnamed'} (group {group.id}); {weak[own].mean():.0%} of its Gaussians show little"
        rows.append(Row("thing", what, round(share * whole), share, truth.loss(scene.cloud[rest]).psnr))
    return rows


def _seen(cloud: GaussianCloud, views: Sequence[View]) -> NDArray[np.bool_]:
    """`[V, N]`, which Gaussians each view shows."""
    return np.stack([(contributions(cloud, view.camera) > SEEN).numpy() for view in views])


def _views(cloud: GaussianCloud, seen: NDArray[np.bool_]) -> list[Row]:
    """How many views, the one that adds most first, show most of what all show."""
    visible, covered, shown = max(int(seen.any(axis=0).sum()), 1), np.zeros(len(cloud), bool), list[float]()
    for _ in range(len(seen)):
        covered |= seen[int(np.argmax((seen & ~covered).sum(axis=1)))]
        shown.append(float(covered.sum()) / visible)
    rows = []
    for cover in COVERS:
        needed = next((i + 1 for i, share in enumerate(shown) if share >= cover), len(shown))
        what = f"all but {needed} of {len(seen)} views"
        rows.append(Row("views", what, 0, 1 - needed / len(seen), None, shown[needed - 1]))
    return rows


def _vectors(scene: Scene, encoder: Encoder | None) -> list[Row]:
    """The vectors of groups with fewer dimensions: their principal ones, and the share of things named as before."""
    field = scene.language
    if field is None or not len(field.embeddings):
        return []
    whole, width = field.embeddings.size * FLOAT, field.embeddings.shape[1]
    before = _names(field, encoder, scene.frame)
    rows = []
    for kept in (d for d in DIMENSIONS if d < min(field.embeddings.shape)):
        after = _names(replace(field, embeddings=shortened(field.embeddings, kept)), encoder, scene.frame)
        same = [a == b for a, b in zip(before, after, strict=True)]
        saved = whole - FLOAT * kept * (len(field.embeddings) + width)
        what = f"all but {kept} of {width} dimensions of the vectors"
        rows.append(Row("vectors", what, saved, saved / whole, None, float(np.mean(same)) if same else None))
    return rows


def shortened(vectors: NDArray[np.float32], dimensions: int) -> NDArray[np.float32]:
    """Vectors `[G, D]` projected on their principal `dimensions`, of unit length; rows of zeros stay."""
    _, _, axes = np.linalg.svd(vectors.astype(np.float64), full_matrices=False)
    flat = vectors @ axes[:dimensions].T @ axes[:dimensions]
    length = np.linalg.norm(flat, axis=1, keepdims=True)
    out: NDArray[np.float32] = np.where(length > 1e-8, flat / np.maximum(length, 1e-8), 0).astype(np.float32)
    return out


def _names(field: LanguageField, encoder: Encoder | None, frame: Frame) -> list[str]:
    """The names of the objects that have a vector, given anew from it; empty without an encoder."""
    if encoder is None or encoder.fingerprint != field.encoder:
        return []
    try:
        anew = named(field, encoder, frame)
    except BackendError:
        return []
    return [g.label for g in anew.objects() if field.embeddings[g.id].any()]
