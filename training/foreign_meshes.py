"""Evaluate the encoder on third-party objects, a folder of low-poly household meshes. Nothing is trained on them.

`python -m scenewright.training.foreign_meshes FOLDER [--encoder SPEC]`. The expected kinds are listed here for the file
names of the Kenney furniture kit.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ..gaussians.assets.modeling import light, make, sampling
from ..gaussians.cloud import GaussianCloud
from ..gaussians.language import encoders
from ..gaussians.language.encoders.probability import labels, probability
from . import damage
from .augment import plain
from .renders import WHOLE, Thing, pictures

SAMPLES = 12_000  # Gaussians per mesh; enough for sharp borders with random samples
_NAMES: dict[str, tuple[str, ...]] = {
    "bathroomCabinetDrawer": ("cabinet", "sink"), "bathroomSink": ("sink",), "bear": ("bear trophy",),
    "bedSingle": ("bed",), "benchCushionLow": ("bench", "ottoman"), "bookcaseOpenLow": ("bookshelf", "wall shelf"),
    "cabinetBedDrawerTable": ("nightstand", "side table", "cabinet", "dresser"), "chair": ("chair",),
    "chairModernCushion": ("chair",), "chairRounded": ("chair",), "desk": ("desk",), "dryer": ("washing machine",),
    "kitchenBlender": ("blender",), "kitchenCabinetCornerInner": ("cabinet",), "kitchenFridge": ("fridge",),
    "kitchenMicrowave": ("microwave",), "kitchenStove": ("stove", "oven"), "lampRoundTable": ("table lamp",),
    "lampSquareTable": ("table lamp",), "loungeChair": ("armchair",), "loungeDesignSofaCorner": ("sofa",),
    "loungeSofaCorner": ("sofa",), "plant": ("potted plant",), "radio": ("radio",), "rugRound": ("rug",),
    "rugSquare": ("rug",), "speaker": ("speaker",), "stoolBar": ("stool",), "table": ("table", "dining table", "desk"),
    "tableCoffeeGlassSquare": ("coffee table", "side table"), "televisionModern": ("television", "monitor"),
    "toaster": ("toaster",), "trashcan": ("bin",),
}  # fmt: skip


@dataclass(frozen=True)
class Verdict:
    """Result for one mesh: accepted kinds (none if the encoder has no name for it), predicted kind, probability."""

    name: str
    accepted: tuple[str, ...]
    guess: str
    sized: str  # prediction with the size of the mesh taken as metres
    sure: float
    asked: float  # probability of the best accepted name; of the best of all names where none is accepted


def judge(encoder: encoders.Encoder, folder: Path) -> list[Verdict]:
    """Predictions for every known mesh in `folder`, from the mean vector of four views.

    Meshes without an entry in the table of names are skipped.

    Raises:
        BackendError: the encoder fails.
    """
    verdicts = []
    for path in sorted(folder.glob("*.glb")):
        if path.stem not in _NAMES:
            continue
        thing = Thing(read(path), path.stem, WHOLE, 0, against_wall=False)
        seen = pictures(thing, np.random.default_rng(len(path.stem)))
        if seen is None:
            continue
        shown = (plain(torch.from_numpy(seen), encoder.image_size) * 255 + 0.5).to(torch.uint8).permute(0, 2, 3, 1)
        mean = encoder.encode_images(shown.contiguous().numpy()).mean(axis=0, keepdims=True)
        guess, sure = labels(encoder, mean)[0]
        low, high = damage.extent(thing.cloud)
        sized = labels(encoder, mean, (high - low)[None])[0][0]
        accepted = tuple(n for n in _NAMES[path.stem] if n in encoder.vocabulary.names)
        asked = max(float(probability(encoder, n, mean)[0]) for n in accepted or encoder.vocabulary.names)
        verdicts.append(Verdict(path.stem, accepted, guess, sized, sure, asked))
    return verdicts


def summary(verdicts: list[Verdict], threshold: float) -> dict[str, Any]:
    """Top-1 over meshes with an accepted name, the share of them found by name, and the refused share of the others."""
    named = [v for v in verdicts if v.accepted]
    others = [v for v in verdicts if not v.accepted]
    return {
        "named": len(named),
        "top1": round(float(np.mean([v.guess in v.accepted for v in named])), 3),
        "top1_with_size": round(float(np.mean([v.sized in v.accepted for v in named])), 3),
        "found": round(float(np.mean([v.asked >= threshold for v in named])), 3),
        "without_name": len(others),
        "refused": round(float(np.mean([v.asked < threshold for v in others])), 3) if others else None,
        "wrong": {v.name: v.guess for v in named if v.guess not in v.accepted},
    }


def read(path: Path) -> GaussianCloud:
    """Convert a mesh file to Gaussians: one flat colour per material, z up, base at z = 0, lit as our assets are."""
    import trimesh

    scene: Any = trimesh.load(path, force="scene")
    meshes = [scene.geometry[scene.graph[node][1]].copy().apply_transform(scene.graph[node][0])
              for node in scene.graph.nodes_geometry]  # fmt: skip
    total = sum(mesh.area for mesh in meshes)
    parts = [_sampled(mesh, max(20, round(SAMPLES * mesh.area / total)), index) for index, mesh in enumerate(meshes)]
    xyz, normal, rgb = (np.concatenate(column) for column in zip(*parts, strict=True))
    low, high = xyz.min(axis=0), xyz.max(axis=0)
    xyz = xyz - np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    sun = light.SUN / np.linalg.norm(light.SUN)
    bright = 0.6 + 0.1 * normal[:, 2] + 0.4 * np.clip(normal @ sun, 0, None)
    side = np.full((len(xyz), 2), np.sqrt(total / len(xyz)))
    samples = sampling.Samples(xyz, _frames(normal), side, np.zeros((len(xyz), 2)), np.zeros(len(xyz), dtype=np.int64))
    return make.flat_gaussians(samples, rgb * bright[:, None])


def _sampled(mesh: Any, count: int, seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Points, normals and colours sampled uniformly on a mesh. glTF's y-up becomes z-up, its front +z becomes -y."""
    import trimesh

    points, faces = trimesh.sample.sample_surface(mesh, count, seed=seed)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    material = getattr(mesh.visual, "material", None)
    factor = getattr(material, "baseColorFactor", None)
    linear = np.array([128, 128, 128] if factor is None else factor[:3], dtype=np.float64) / 255
    rgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)  # glTF factors are linear
    return points @ turn.T, mesh.face_normals[faces] @ turn.T, np.tile(rgb, (len(points), 1))


def _frames(normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """`[N, 3, 3]` matrices with orthonormal columns; the last column is the normal."""
    helper = np.where(np.abs(normal[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    first = np.cross(helper, normal)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(normal, first), normal], axis=2)


def main(argv: list[str] | None = None) -> int:
    """Print one line per mesh and the summary as JSON."""
    parser = argparse.ArgumentParser(prog="python -m scenewright.training.foreign_meshes")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--encoder", default="auto")
    options = parser.parse_args(argv)
    encoder = encoders.load(options.encoder)
    verdicts = judge(encoder, options.folder)
    for v in verdicts:
        names = "/".join(v.accepted) or "(no name)"
        print(f"{v.name:28} {v.guess:16} {v.sized:16} {v.sure:5.2f}  asked {v.asked:5.2f}  {names}")
    print(json.dumps(summary(verdicts, encoder.calibration.threshold)))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
