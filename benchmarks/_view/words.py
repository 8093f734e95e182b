"""Words to changed bytes: a thing of 10,000 of a million Gaussians is recoloured; seconds and bytes at the server.

The time is from the message to the last byte of the change at a client on this machine, without a browser.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any

import torch

from ...agent.session.session import Session
from ...agent.view.columns import width
from ...gaussians.language.field.apart import set_apart
from ...gaussians.scene import Scene
from ..edit import crowded
from .client import Page, served

GAUSSIANS, QUICK_GAUSSIANS = 1_000_000, 100_000
SHARE = 100  # one in so many is recoloured
_WORDS = ("make it red", "make it blue", "make it yellow")


def measure(quick: bool) -> list[dict[str, Any]]:
    """A row for each edit: seconds until all bytes are there, and bytes over those that changed."""
    scene, group = with_thing(crowded(QUICK_GAUSSIANS if quick else GAUSSIANS), SHARE)
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as folder:
        session = Session(scene, planner="grammar", log=Path(folder) / "log.jsonl")
        session.embed()  # names are no part of what is measured
        with served(session) as server, Page(server.port, server.cookie) as page:
            page.ask("select", mode="set", group=group)
            for text in _WORDS:
                before = server.hub.shown
                started, cpu = time.perf_counter(), time.process_time()
                page.send({"type": "say", "id": 1000 + len(rows), "text": text})
                page.received, page.headers = 0, []
                while not page.headers:
                    page.take()
                seconds, used = time.perf_counter() - started, time.process_time() - cpu
                said = page.take()
                while said["type"] != "said":
                    said = page.take()
                own = {s: round(v, 4) for s, v in server.hub.session.states[-1].receipts[0].seconds.items()}
                least = changed_bytes(before.scene, server.hub.shown.scene)
                rows.append({"words": text, "seconds": seconds, "cpu_seconds": used, "bytes": page.received,
                             "changed_bytes": least,
                             "bytes_over_changed": page.received / least, "stages": own})  # fmt: skip
    return rows


def with_thing(scene: Scene, share: int) -> tuple[Scene, int]:
    """The scene with one thing of a share of its Gaussians, and its group: those of a box nearest to a corner."""
    cloud = scene.cloud
    count = len(cloud) // share
    own = (cloud.group == 7).nonzero()[:, 0]
    near = (cloud.means[own] - cloud.means[own].min(dim=0).values).norm(dim=1).argsort()[:count]
    return set_apart(scene, own[near].sort().values.numpy(), "box", "user")


def changed_bytes(before: Scene, after: Scene) -> int:
    """Bytes of the columns, as the page has them, in the rows in which they changed; both have the same rows."""
    a, b = before.cloud, after.cloud
    degree = b.degree

    def rows(x: torch.Tensor, y: torch.Tensor) -> torch.Tensor:
        return (x != y).reshape(len(x), -1).any(dim=1) if x is not y else torch.zeros(len(x), dtype=torch.bool)

    parts = {
        "position": rows(a.means, b.means),
        "shape": rows(a.quats, b.quats) | rows(a.scales, b.scales),
        "color": rows(a.sh[:, :1], b.sh[:, :1]) | rows(a.opacities, b.opacities),
        "harmonics": rows(a.sh[:, 1:], b.sh[:, 1:]),
        "group": rows(a.group, b.group),
    }
    return sum(int(changed.sum()) * width(name, degree) for name, changed in parts.items())
