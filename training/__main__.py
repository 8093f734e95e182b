"""`python -m scenewright.training --out DIR`: train an encoder on procedural assets.

Training uses seeds from 0, calibration from 10,000, measurement from 20,000.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import torch

from ..gaussians import assets
from ..gaussians.language.encoders.backends.embedded import Embedded
from . import captions, export, fit, foreign_meshes, in_rooms, measure, renders

CALIBRATION_SEEDS, MEASURING_SEEDS = 10_000, 20_000
ROOMS = 16  # furnished rooms for measurement
HELD_OUT = 8  # seeds of each kind for calibration, and as many for measurement


def main(argv: list[str] | None = None) -> int:
    """Render, train, export, calibrate and measure, with progress on stderr."""
    options = _options(argv)
    torch.set_num_threads(options.threads)
    start = time.monotonic()

    def report(line: str) -> None:
        print(f"{time.monotonic() - start:7.1f} s  {line}", file=sys.stderr, flush=True)

    kinds = assets.kinds(shown=True)
    cache = options.cache or renders.cache_folder()
    job_words = captions.vocabulary(kinds)
    job = fit.task(job_words, captions.words(job_words))
    shown = renders.cached("train", kinds, range(options.assets), cache, report)
    held = [
        renders.cached(name, kinds, range(first, first + HELD_OUT), cache, report)
        for name, first in (("calibrate", CALIBRATION_SEEDS), ("measure", MEASURING_SEEDS))
    ]
    effort = fit.Effort(options.minutes, options.steps, options.seed, options.bf16)
    rendered = time.monotonic() - start
    towers = fit.train(shown, job, effort, report)
    export.write_weights(options.out, towers, job)
    rule = measure.calibrate(Embedded(options.out), held[0], measure.size_priors(shown), towers.scale)
    export.write_calibration(options.out, rule)
    card = {
        "seed": effort.seed,
        "bf16": effort.half,
        "steps": towers.steps,
        "training_minutes": effort.minutes,
        "designs_per_kind": options.assets,
        "things": len(shown),
        "pictures": len(shown) * renders.VIEWS,
        "cores": os.cpu_count(),
        "render_seconds": round(rendered, 1),
        "total_seconds": round(time.monotonic() - start, 1),
    } | _measured(Embedded(options.out), held[1], options.strangers)
    export.write_calibration(options.out, replace(rule, measured=card["figures"]))
    export.write_json(options.out / "measured.json", card)
    for key, value in card["figures"].items():
        report(f"{key:36} {value:.4g}")
    return 0


def _options(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m scenewright.training", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder to write the encoder to")
    parser.add_argument("--minutes", type=float, default=12.0, help="wall time of the training alone")
    parser.add_argument("--steps", type=int, help="exact number of steps, instead of a time")
    parser.add_argument("--bf16", action="store_true", help="convolutions in bfloat16: faster on recent processors")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--assets", type=int, default=60, help="designs of each kind to learn from")
    parser.add_argument("--strangers", type=Path, help="folder of third-party meshes to evaluate on as well")
    parser.add_argument(
        "--threads", type=int, default=os.cpu_count() or 1, help="CPU threads; use fewer on a shared machine"
    )
    parser.add_argument(
        "--cache", type=Path, help=f"where rendered pictures are kept (default {renders.cache_folder()})"
    )
    return parser.parse_args(argv)


def _measured(encoder: Embedded, crops: renders.Crops, meshes: Path | None) -> dict[str, Any]:
    """The figures of the encoder card."""
    image_ms, text_ms = measure.milliseconds(encoder)
    files = ("image.onnx", "text.onnx", "words.json")
    result = {
        "fingerprint": encoder.fingerprint,
        "bytes": {name: (encoder.folder / name).stat().st_size for name in files},
        "milliseconds_per_image": round(image_ms, 3),
        "milliseconds_per_phrase": round(text_ms, 3),
        "figures": {k: round(v, 4) for k, v in measure.figures(encoder, crops).items()},
        "simulated": {"rooms": measure.ROOMS, "room": measure.ROOM, "merges": measure.MERGES},
        "kinds": measure.confusions(encoder, crops),
        "rooms": in_rooms.judge(encoder, range(MEASURING_SEEDS, MEASURING_SEEDS + ROOMS)),
    }
    if meshes is not None:
        result["strangers"] = foreign_meshes.summary(
            foreign_meshes.judge(encoder, meshes), encoder.calibration.threshold
        )
    return result


if __name__ == "__main__":
    raise SystemExit(main())
