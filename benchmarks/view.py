"""bench view: the page: its renderer in a browser, words to changed bytes, and what strangers and faults do to it."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from typing import Any

from ..gaussians.errors import BackendError
from ._view import drawing, engines, faults, first, levels, words
from .harness import Direction, Metric, Result

GOAL_PSNR, GOAL_RIGHT, GOAL_CLICK_MS, GOAL_WORDS_SECONDS, GOAL_BYTES = 30.0, 0.95, 100.0, 0.5, 1.2
GOAL_OVER_DROPPING = 1.0
GOAL_FIRST = {"room": 5.0, "million": 12.0}  # seconds
GOAL_BESIDE = 0.8  # of the better engine's frame time


PARTS = ("browser", "beside", "words", "levels", "faults")


def run(quick: bool, parts: Sequence[str] = PARTS) -> Result:
    """Measure all of it; where no browser can be driven, all but the rows of drawing, and say so."""
    measures = {"browser": _browser, "beside": _beside, "words": _words, "levels": _levels, "faults": _faults}
    found = [measures[name](quick) for name in PARTS if name in parts]
    return Result(
        title="the page in a browser with software WebGL, and its server",
        accuracy="",
        metrics=tuple(m for metrics, _ in found for m in metrics),
        points=(),
        notes=(
            *(note for _, notes in found for note in notes),
            "opened: from the address of an exported file to its first whole picture.",
            "first: from the address of a server to the first whole picture, second visit; pictures: drawn meanwhile.",
            "frame: projecting, blending and presenting; the sort is a worker's and not in it.",
            "beside: a frame from the camera's move to its pixels, while each engine sorts.",
            "words.seconds: to the last byte of the change at a client, without the browser.",
            "level: PSNR to the scene before writing; over_dropping: against leaving out the least visible of it.",
            "lod: drawn as render --lod does, against the finest level; draw: processor time of a picture.",
        ),
    )


_Found = tuple[list[Metric], list[str]]  # figures, and notes


def _browser(quick: bool) -> _Found:
    metrics: list[Metric] = []
    try:
        drawn, opened = drawing.measure(quick), first.measure(quick)
    except BackendError as error:
        return [], [f"the rows of drawing (room, sh0 to sh3, million) were left out: {error}."]
    for row in drawn:
        name = row["scene"]
        metrics += [
            Metric(f"{name}.opened", row["opened"], "s", "lower", 0.4),
            Metric(f"{name}.psnr", row["psnr"], "dB", "higher", 0.02, GOAL_PSNR),
            Metric(f"{name}.clicks_right", row["right"], "1", "higher", 0.02, GOAL_RIGHT),
            Metric(f"{name}.click", row["click"], "ms", "lower", 0.4, GOAL_CLICK_MS),
        ]
        metrics += [
            Metric(f"{name}.{key}", value, "ms", "lower", 0.4) for key, value in row.items() if key.startswith("frame_")
        ]
    metrics += [
        Metric(f"first.{row['scene']}.seconds", row["seconds"], "s", "lower", 0.4, GOAL_FIRST.get(row["scene"]))
        for row in opened
    ]
    metrics += [Metric(f"first.{row['scene']}.pictures", row["pictures"], "count") for row in opened]
    return metrics, []


def _beside(quick: bool) -> _Found:
    try:
        rows, left_out = engines.measure(quick)
    except BackendError as error:
        return [], [f"the rows beside other engines were left out: {error}."]
    return beside(rows), left_out


def beside(rows: list[engines.Row]) -> list[Metric]:
    """Frames and processor time of each engine, and ours over the better other one."""
    metrics = []
    cases = dict.fromkeys((row.driver, row.scene, row.size) for row in rows)
    for case in cases:
        key = ".".join(("beside", *case))
        here = {row.engine: row for row in rows if (row.driver, row.scene, row.size) == case}
        for name, row in here.items():
            way: Direction = "lower" if name == engines.OURS else "neither"
            metrics += [
                Metric(f"{key}.{name}.frame", row.frame, "ms", way, 0.4),
                Metric(f"{key}.{name}.cpu", row.cpu, "ms", way, 0.2),
                Metric(f"{key}.{name}.psnr", row.psnr, "dB"),
            ]
        ours, others = here.pop(engines.OURS), here.values()
        if others:
            frame = ours.frame / min(row.frame for row in others)
            cpu = ours.cpu / min(row.cpu for row in others)
            metrics.append(Metric(f"{key}.ratio", frame, "x", "lower", 0.3, GOAL_BESIDE))
            metrics.append(Metric(f"{key}.cpu_ratio", cpu, "x", "lower", 0.15, GOAL_BESIDE))
    return metrics


def _words(quick: bool) -> _Found:
    said = words.measure(quick)
    seconds = statistics.median(row["seconds"] for row in said)
    return [
        Metric("words.seconds", seconds, "s", "lower", 0.4, GOAL_WORDS_SECONDS),
        Metric("words.bytes", max(row["bytes_over_changed"] for row in said), "x", "lower", 0.05, GOAL_BYTES),
    ], []


def _levels(quick: bool) -> _Found:
    leveled, missing = levels.measure(quick)
    return [metric for row in leveled for metric in (_level if "level" in row else _lod)(row)], list(missing)


def _faults(quick: bool) -> _Found:
    rows = faults.measure(quick)
    bad = [row for row in rows if row.get("changed") or not all(row.get(k, True) for k in _HOLD)]
    return [Metric("faults.wrong", len(bad), "count", "lower", 0, 0)], [f"wrong: {row}" for row in bad]


def _level(row: dict[str, Any]) -> list[Metric]:
    """A level as it is on disk; nothing is left out at the finest one, so it is not compared."""
    key = f"{row['scene']}.level{row['level']}"
    found = [
        Metric(f"{key}.gaussians", row["gaussians"], "count"),
        Metric(f"{key}.bytes", row["bytes"], "B", "lower", 0.03),
        Metric(f"{key}.draw", row["draw"], "ms", "lower", 0.4),
        Metric(f"{key}.psnr", row["psnr"], "dB", "higher", 0.02),
    ]
    if row["level"]:
        gain = row["psnr"] - row["dropped"]
        found.append(Metric(f"{key}.over_dropping", gain, "dB", "higher", 0.1, GOAL_OVER_DROPPING))
    return found


def _lod(row: dict[str, Any]) -> list[Metric]:
    """Pictures drawn with levels."""
    key = f"{row['scene']}.lod.{row['view']}"
    return [
        Metric(f"{key}.gaussians", row["share"], "share", "lower", 0.05),
        Metric(f"{key}.draw", row["draw"], "ms", "lower", 0.4),
        Metric(f"{key}.draw_finest", row["draw_finest"], "ms"),
        Metric(f"{key}.psnr", row["psnr"], "dB", "higher", 0.02),
        Metric(f"{key}.psnr_least", row["psnr_least"], "dB", "higher", 0.03),
    ]


_HOLD = ("same", "log_whole", "refused")
