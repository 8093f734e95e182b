"""`python -m scenewright.training --out DIR`: train an encoder on procedural assets and on objects by other artists."""

from __future__ import annotations

import argparse
import os
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import torch

from ..gaussians.language.encoders.backends.embedded import Embedded
from . import captions, export, fit, foreign_meshes, in_rooms, measure, renders, sets, strangers

ROOMS = 16  # furnished rooms for measurement
CALIBRATION_ROOMS = 6  # likewise for the usual confidence


def main(argv: list[str] | None = None) -> int:
    """Render, train, export, calibrate and measure, with progress on stderr."""
    options = _options(argv)
    torch.set_num_threads(options.threads)
    start = time.monotonic()

    def report(line: str) -> None:
        print(f"{time.monotonic() - start:7.1f} s  {line}", file=sys.stderr, flush=True)

    places = sets.Places(options.objects, options.cache or renders.cache_folder())
    job_words = sets.vocabulary(options.objects is not None)
    job = fit.task(job_words, captions.words(job_words))
    shown = sets.training(options.assets, places, report)
    held, unseen = (sets.held_out(use, places, report) for use in ("calibrate", "measure"))
    effort = fit.Effort(
        options.minutes, options.steps, options.seed, options.bf16, options.resume, options.learning_rate
    )
    rendered = time.monotonic() - start
    crops = renders.joined(shown)
    priors = measure.size_priors(crops)
    if options.keep_weights:
        scale, steps = Embedded(options.out).calibration.scale, 0
    else:
        towers = fit.train(crops, job, effort, report, places.cache / "checkpoint.pt")
        export.write_weights(options.out, towers, job)
        scale, steps = towers.scale, towers.steps
    rule = measure.calibrate(Embedded(options.out), held, priors, scale)
    export.write_calibration(options.out, rule)
    rooms = range(sets.CALIBRATION_SEEDS, sets.CALIBRATION_SEEDS + CALIBRATION_ROOMS)
    usual = in_rooms.confidence(Embedded(options.out), rooms)
    rule = replace(rule, confidence=usual)
    credits = strangers.credits(options.objects) if options.objects else []
    card = {
        "seed": effort.seed,
        "bf16": effort.half,
        "steps": steps,
        "learning_rate": effort.peak,
        "training_minutes": effort.minutes,
        "designs_per_kind": options.assets,
        "things": len(crops),
        "pictures": len(crops) * renders.VIEWS,
        "objects_by_others": strangers.trained(options.objects) if options.objects else 0,
        "cores": os.cpu_count(),
        "render_seconds": round(rendered, 1),
        "total_seconds": round(time.monotonic() - start, 1),
        "credits": credits,
    } | _measured(Embedded(options.out), unseen, options.strangers)
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
    parser.add_argument("--resume", type=Path, help="checkpoint.pt in the cache of an earlier training")
    parser.add_argument("--keep-weights", action="store_true", help="calibrate and measure those of --out as they are")
    parser.add_argument("--learning-rate", type=float, default=fit.PEAK_LR, help="the highest one")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--assets", type=int, default=40, help="designs of each kind to learn from")
    parser.add_argument("--objects", type=Path, help="folder of objects by other artists to learn from as well")
    parser.add_argument("--strangers", type=Path, help="folder of third-party meshes to evaluate on as well")
    parser.add_argument(
        "--threads", type=int, default=os.cpu_count() or 1, help="CPU threads; use fewer on a shared machine"
    )
    parser.add_argument(
        "--cache", type=Path, help=f"where rendered pictures are kept (default {renders.cache_folder()})"
    )
    return parser.parse_args(argv)


def _measured(encoder: Embedded, unseen: list[renders.Crops], meshes: Path | None) -> dict[str, Any]:
    """The figures of the encoder card, on unseen designs of ours, and on packs and meshes of others."""
    crops = unseen[0]
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
        "rooms": in_rooms.judge(encoder, range(sets.MEASURING_SEEDS, sets.MEASURING_SEEDS + ROOMS)),
    }
    if len(unseen) > 1:
        result["packs"] = {k: round(v, 4) for k, v in measure.on_strangers(encoder, unseen[1]).items()}
    if meshes is not None:
        result["strangers"] = foreign_meshes.summary(
            foreign_meshes.judge(encoder, meshes), encoder.calibration.threshold
        )
    return result


if __name__ == "__main__":
    raise SystemExit(main())
