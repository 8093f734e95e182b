"""bench view: the page: its renderer in a browser, words to changed bytes, and what strangers and faults do to it."""

from __future__ import annotations

import statistics

from ..gaussians.errors import BackendError
from ._view import drawing, faults, words
from .harness import Metric, Result

GOAL_PSNR, GOAL_RIGHT, GOAL_CLICK_MS, GOAL_WORDS_SECONDS, GOAL_BYTES = 30.0, 0.95, 100.0, 0.5, 1.2


def run(quick: bool) -> Result:
    """Measure all of it; where no browser can be driven, all but the rows of drawing, and say so."""
    metrics: list[Metric] = []
    left_out: list[str] = []
    try:
        drawn = drawing.measure(quick)
    except BackendError as error:
        drawn = []
        left_out.append(f"the rows of drawing (room, sh0 to sh3, million) were left out: {error}.")
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
    said = words.measure(quick)
    seconds = statistics.median(row["seconds"] for row in said)
    metrics += [
        Metric("words.seconds", seconds, "s", "lower", 0.4, GOAL_WORDS_SECONDS),
        Metric("words.bytes", max(row["bytes_over_changed"] for row in said), "x", "lower", 0.05, GOAL_BYTES),
    ]
    rows = faults.measure(quick)
    bad = [row for row in rows if row.get("changed") or not all(row.get(k, True) for k in _HOLD)]
    metrics.append(Metric("faults.wrong", len(bad), "count", "lower", 0, 0))
    return Result(
        title="the page in a browser with software WebGL, and its server",
        accuracy="",
        metrics=tuple(metrics),
        points=(),
        notes=(
            *left_out,
            "opened: from the address of an exported file to its first whole picture.",
            "frame: projecting, blending and presenting; the sort is a worker's and not in it.",
            "words.seconds: to the last byte of the change at a client, without the browser.",
            *(f"wrong: {row}" for row in bad),
        ),
    )


_HOLD = ("same", "log_whole", "refused")
