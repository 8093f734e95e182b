"""`python -m scenewright.training.contours --out FILE`: render pictures, train the contour network, export, measure.

Beside `FILE` goes a card of the same name with the ending .json: settings, figures, objects used and their licences.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

import torch

from ...gaussians.errors import UserError
from .. import export as common
from ..renders import cache_folder
from . import calibrate, dataset, export, fit, measure
from .model import Contours

HELD_OUT_SHARDS = 6
CALIBRATION_SHARDS = 2  # of them; the others measure


def main(argv: list[str] | None = None) -> int:
    """Make the pictures, train, export and measure, with progress on stderr."""
    options = _options(argv)
    torch.set_num_threads(options.threads)
    begun = time.monotonic()

    def report(line: str) -> None:
        print(f"{time.monotonic() - begun:7.1f} s  {line}", file=sys.stderr, flush=True)

    base = options.cache or cache_folder().parent / "contours"
    sets = [
        dataset.cached(count, options.data_seed, options.meshes, where, options.workers, report)
        for count, where in (
            (options.shards, dataset.folder(base, options.data_seed, held_out=False)),
            (HELD_OUT_SHARDS, dataset.folder(base, options.data_seed, held_out=True)),
        )
    ]
    data, fitting, judged = (
        dataset.read(paths) for paths in (sets[0], sets[1][:CALIBRATION_SHARDS], sets[1][CALIBRATION_SHARDS:])
    )
    report(f"{len(data)} pictures to learn from, {len(judged)} held out")
    start, before = _start(options.start)
    effort = fit.Effort(options.minutes, options.steps, options.seed, half=options.bf16)
    trained = fit.train(data, effort, report, start)
    run = {
        "seed": effort.seed, "data_seed": options.data_seed, "pictures": len(data), "steps": trained.steps,
        "batch": effort.batch, "crop": effort.side, "bf16": effort.half, "loss": round(trained.loss, 4),
    }  # fmt: skip
    runs = [*before, run]
    if options.keep is not None:
        torch.save(trained.net.state_dict(), options.keep)
        common.write_json(options.keep.with_suffix(".json"), {"runs": runs})
    report(measure.shown(finish(options, trained.net, runs, fitting, judged)["figures"]))
    return 0


def finish(
    options: argparse.Namespace,
    net: Contours,
    runs: list[dict[str, Any]],
    fitting: dataset.Pictures,
    judged: dataset.Pictures,
) -> dict[str, Any]:
    """Calibrate on the pictures `fitting`, export, measure on `judged`, and write the card; returns it.

    `runs` are the settings of each run of training, the first one first.
    """
    seed = int(runs[-1]["seed"])
    net = calibrate.calibrated(net, fitting, seed)
    export.write(options.out, net)
    card = {
        "steps": sum(run["steps"] for run in runs), "pictures": max(run["pictures"] for run in runs), "runs": runs,
        "parameters": sum(p.numel() for p in net.parameters()), "bytes": options.out.stat().st_size,
        "figures": measure.report(options.out, judged, options.captures),
        "reliability": calibrate.reliability(net, judged, seed), "objects": _sources(options.meshes),
    }  # fmt: skip
    common.write_json(options.out.with_suffix(".json"), card)
    return card


def _start(path: Path | None) -> tuple[Contours | None, list[dict[str, Any]]]:
    """The network of a file that `--keep` wrote and the runs behind it; only numbers are read from the file.

    Raises:
        UserError: the file or the list of runs beside it is missing.
    """
    if path is None:
        return None, []
    beside = path.with_suffix(".json")
    if not (path.is_file() and beside.is_file()):
        raise UserError(f"--start needs {path} and {beside}, as --keep writes them")
    net = Contours()
    net.load_state_dict(torch.load(path, weights_only=True))
    return net, json.loads(beside.read_text(encoding="utf-8"))["runs"]


def _sources(meshes: Path | None) -> dict[str, Any]:
    """What the pictures were made of: our own furniture, and packs of other artists with their licences."""
    packs: dict[str, dict[str, Any]] = {}
    if meshes is not None:
        for entry in json.loads((meshes / "index.json").read_text(encoding="utf-8")):
            pack = {"artist": entry["artist"], "licence": entry["licence"], "objects": 0}
            packs.setdefault(entry["pack"], pack)["objects"] += 1
    return {"own": "the procedural furniture of this project", "packs": dict(sorted(packs.items()))}


def _options(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m scenewright.training.contours", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="file to write the network to, ending in .onnx")
    parser.add_argument("--minutes", type=float, default=30.0, help="wall time of the training alone")
    parser.add_argument("--steps", type=int, help="exact number of steps, instead of a time")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--shards", type=int, default=50, help=f"sets of {dataset.SHARD} pictures to learn from")
    parser.add_argument("--data-seed", type=int, default=0, help="seed of the pictures")
    parser.add_argument("--meshes", type=Path, help="folder of foreign objects (.glb) with an index.json")
    parser.add_argument("--captures", type=Path, help="folder of captures with true masks to measure on")
    parser.add_argument("--start", type=Path, help="weights to go on from, as --keep writes them")
    parser.add_argument("--keep", type=Path, help="file to keep the trained weights in, for --start")
    parser.add_argument("--bf16", action="store_true", help="convolutions in bfloat16: faster on recent processors")
    parser.add_argument("--workers", type=int, default=2, help="processes that make pictures")
    parser.add_argument("--threads", type=int, default=1, help="CPU threads of the training")
    parser.add_argument("--cache", type=Path, help="where pictures are kept")
    return parser.parse_args(argv)


if __name__ == "__main__":
    raise SystemExit(main())
