"""`python -m scenewright.training.join FOLDER... --out DIR`: one encoder from the image towers of several encoders.

The towers see the same pictures, and their vectors stand side by side. Each label gets one new vector, fitted on the
training set, and then on that and the groups of whole rooms (`room_groups.py`). A tower that learnt our assets as they
are tells those apart best; a tower that learnt them varied and beside objects by others carries over to strangers.
Phrases go through the text tower of the last encoder, and from there to the new vectors of the labels that they are
near to. Its vocabulary is that of the last encoder.
`python -m scenewright.training --out DIR --keep-weights` then calibrates and measures the result.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn
from torch.nn import functional

from ..gaussians.language.encoders.backends.embedded import Embedded
from ..gaussians.language.encoders.calibration import Calibration
from . import captions, export, fit, renders, room_groups, sets
from .augment import augment, plain
from .model import IMAGE_SIZE
from .room_groups import RoomGroups

STEPS, THINGS = 4000, 512  # of the fit, and things per step
RATE, SCALE_RATE = 2e-3, 1e-2  # at the start; they fall to 0
FIRST_SCALE, MAX_SCALE = 30.0, 60.0  # of the cosines
AUGMENTED = 2  # of the views of each thing; the others are seen as they are
FIRST_SEED = 7_000_000  # of the augmentation; the training of a tower sees others
SHARP = 25.0  # scale of the softmax over labels that a phrase goes through
PARTS = 32  # things whose pictures are encoded at a time
ROOM_GROUPS = 512  # groups and regions of rooms per step


@dataclass(frozen=True, eq=False)
class Anchors:
    """Unit vectors of the labels of a task `[C, F]`, and the scale of their cosines with pictures."""

    vectors: NDArray[np.float32]
    scale: float


def features(towers: Sequence[Embedded], crops: renders.Crops, seed: int) -> NDArray[np.float32]:
    """`[M, V, F]` vectors of crops by all towers, side by side; `AUGMENTED` of the views are augmented."""
    found = []
    for first in range(0, len(crops), PARTS):
        pixels = torch.from_numpy(np.array(crops.pixels[first : first + PARTS]))
        count, views = pixels.shape[:2]
        seen = plain(pixels.flatten(0, 1)).reshape(count, views, 3, IMAGE_SIZE, IMAGE_SIZE)
        changed = augment(pixels[:, -AUGMENTED:].flatten(0, 1), seed + first)
        seen[:, -AUGMENTED:] = changed.reshape(count, AUGMENTED, *changed.shape[1:])
        pictures = (seen.flatten(0, 1).permute(0, 2, 3, 1) * 255 + 0.5).clamp(0, 255).to(torch.uint8).numpy()
        rows = np.concatenate([tower.encode_images(np.ascontiguousarray(pictures)) for tower in towers], axis=1)
        found.append(rows.reshape(count, views, -1))
    return np.concatenate(found)


def fit_anchors(
    seen: NDArray[np.float32],
    labels: Sequence[str],
    job: fit.Task,
    seed: int,
    steps: int = STEPS,
    rooms: RoomGroups | None = None,
) -> Anchors:
    """Fit one vector per label, so that views, means over two views, and groups are nearest to that of their label.

    Args:
        seen: `[M, V, F]` vectors of pictures.
        labels: `[M]`.
        rooms: groups of whole rooms; None for none.
    """
    torch.manual_seed(seed)
    pictures, label = torch.from_numpy(seen), torch.tensor([job.classes.index(name) for name in labels])
    often = torch.from_numpy(fit.sampling_weights(label.numpy(), job.classes))
    in_rooms = None if rooms is None else _loss_in_rooms(rooms, job)
    table, log_scale = nn.Parameter(_means(pictures, label, len(job.classes))), nn.Parameter(torch.tensor(FIRST_SCALE))
    log_scale.data.log_()
    optimizer = torch.optim.Adam([{"params": [table], "lr": RATE}, {"params": [log_scale], "lr": SCALE_RATE}])
    falling = torch.optim.lr_scheduler.LambdaLR(optimizer, lambda step: 1 - step / steps)
    for _ in range(steps):
        rows = torch.multinomial(often, THINGS, replacement=True)
        views = torch.rand(THINGS, seen.shape[1]).argsort(dim=1)[:, :2]
        vectors = pictures[rows[:, None], views]  # [THINGS, 2, F]
        anchors, scale = functional.normalize(table, dim=1), log_scale.exp().clamp(max=MAX_SCALE)
        one, mean = functional.normalize(vectors.flatten(0, 1), dim=1), functional.normalize(vectors.mean(dim=1), dim=1)
        single = functional.cross_entropy(scale * one @ anchors.T, label[rows].repeat_interleave(2))
        loss = 0.5 * single + 0.5 * functional.cross_entropy(scale * mean @ anchors.T, label[rows])
        if in_rooms is not None:
            loss = loss + in_rooms(anchors, scale)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        optimizer.step()
        falling.step()
    return Anchors(
        functional.normalize(table.detach(), dim=1).numpy(), log_scale.detach().exp().clamp(max=MAX_SCALE).item()
    )


def _loss_in_rooms(rooms: RoomGroups, job: fit.Task) -> Callable[[torch.Tensor, torch.Tensor], torch.Tensor]:
    """The loss of anchors `[C, F]` and their scale over some groups of rooms; rare labels are drawn more often."""
    vectors = functional.normalize(torch.from_numpy(rooms.vectors), dim=1)
    label = torch.tensor([job.classes.index(name) for name in rooms.labels])
    often = torch.bincount(label, minlength=len(job.classes))[label].float().rsqrt()

    def loss(anchors: torch.Tensor, scale: torch.Tensor) -> torch.Tensor:
        rows = torch.multinomial(often, ROOM_GROUPS, replacement=True)
        return functional.cross_entropy(scale * vectors[rows] @ anchors.T, label[rows])

    return loss


def _means(pictures: torch.Tensor, label: torch.Tensor, count: int) -> torch.Tensor:
    """`[C, F]` unit mean vectors of the pictures of each label; zero where there are none."""
    pooled = functional.normalize(pictures.mean(dim=1), dim=1)
    total = torch.zeros(count, pooled.shape[1]).index_add_(0, label, pooled)
    return functional.normalize(total, dim=1)


def write(folder: Path, towers: Sequence[Embedded], anchors: Anchors) -> None:
    """Write the joined encoder to `folder`: towers, words, and a provisional calibration that holds the scale."""
    folder.mkdir(parents=True, exist_ok=True)
    last = towers[-1]
    words = json.loads((last.folder / "words.json").read_text(encoding="utf-8"))
    near = last.encode_text([*last.vocabulary.names, *last.vocabulary.negatives])
    _save(_joined([tower.folder / "image.onnx" for tower in towers]), folder / "image.onnx")
    _save(_looked_up(last.folder / "text.onnx", near, anchors.vectors), folder / "text.onnx")
    export.write_json(folder / "words.json", words | {"dim": anchors.vectors.shape[1]})
    export.write_calibration(folder, Calibration(anchors.scale, 0.5))


def _joined(paths: Sequence[Path]) -> Any:
    """Image towers side by side, with one input."""
    import onnx

    parts = [onnx.compose.add_prefix(onnx.load(str(path)), f"tower{i}/") for i, path in enumerate(paths)]
    nodes = [node for part in parts for node in part.graph.node]
    for node in nodes:
        node.input[:] = ["images" if name.endswith("/images") else name for name in node.input]
    nodes.append(onnx.helper.make_node("Concat", [p.graph.output[0].name for p in parts], ["vectors"], axis=1))
    entry = parts[0].graph.input[0]
    entry.name = "images"
    output = onnx.helper.make_tensor_value_info("vectors", onnx.TensorProto.FLOAT, ["batch", None])
    weights = [tensor for part in parts for tensor in part.graph.initializer]
    graph = onnx.helper.make_graph(nodes, "images", [entry], [output], weights)
    return onnx.helper.make_model(graph, opset_imports=parts[0].opset_import, ir_version=parts[0].ir_version)


def _looked_up(path: Path, near: NDArray[np.float32], anchors: NDArray[np.float32]) -> Any:
    """A text tower whose vectors are exchanged: each is a mean of the new vectors `[C, F]` of the labels, weighted by a
    softmax of its cosines with their old ones `[C, D]`."""
    import onnx

    model = onnx.load(str(path))
    graph, make = model.graph, onnx.helper.make_node
    old, batch = graph.output[0].name, graph.output[0].type.tensor_type.shape.dim[0].dim_param
    graph.initializer.append(onnx.numpy_helper.from_array(np.ascontiguousarray(SHARP * near.T), "label/near"))
    graph.initializer.append(onnx.numpy_helper.from_array(anchors, "label/anchors"))
    graph.node.extend(
        [
            make("MatMul", [old, "label/near"], ["label/cosines"]),
            make("Softmax", ["label/cosines"], ["label/shares"], axis=1),
            make("MatMul", ["label/shares", "label/anchors"], ["label/vectors"]),
        ]
    )
    del graph.output[:]
    shape = [batch, anchors.shape[1]]
    graph.output.append(onnx.helper.make_tensor_value_info("label/vectors", onnx.TensorProto.FLOAT, shape))
    return model


def _save(model: Any, path: Path) -> None:
    import onnx

    export.halve(model)
    onnx.checker.check_model(model)
    path.write_bytes(model.SerializeToString(deterministic=True))


def main(argv: list[str] | None = None) -> int:
    """Join encoders; see the module."""
    parser = argparse.ArgumentParser(prog="python -m scenewright.training.join", description=__doc__)
    parser.add_argument("folders", type=Path, nargs="+", help="of encoders; words are those of the last")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--objects", type=Path, help="as for the training")
    parser.add_argument("--cache", type=Path, default=renders.cache_folder())
    parser.add_argument("--fits", type=Path, help="folder of fitted rooms (training.fitted_rooms)")
    parser.add_argument("--assets", type=int, default=40, help="designs of each kind to fit the vectors on")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(argv)
    torch.set_num_threads(1)
    vocabulary = sets.vocabulary(options.objects is not None)
    job = fit.task(vocabulary, captions.words(vocabulary))
    towers = [Embedded(folder) for folder in options.folders]

    def report(line: str) -> None:
        print(line, file=sys.stderr, flush=True)

    shown = sets.training(options.assets, sets.Places(options.objects, options.cache), report)
    seen = np.concatenate([features(towers, crops, FIRST_SEED + options.seed) for crops in shown])
    labels = [name for crops in shown for name in crops.labels.tolist()]
    write(options.out, towers, fit_anchors(seen, labels, job, options.seed))
    report("embed rooms")
    others = room_groups.rooms_of_others(options.objects) if options.objects else ()
    embedded = Embedded(options.out)
    groups = room_groups.collect(embedded, chain(room_groups.own_rooms(options.fits), others))
    rooms = room_groups.joined([groups, room_groups.collect_nodes(embedded, room_groups.own_rooms(None))])
    write(options.out, towers, fit_anchors(seen, labels, job, options.seed, rooms=rooms))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
