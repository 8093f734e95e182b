"""bench mcp: sessions of an MCP client in memory and over stdio, and hostile calls, with what they change counted.

The client edits a composed room in five steps, meets two ambiguities (it fills in one form and declines the other, so
that the candidates are told), looks at a picture, and undoes everything; the digest of the scene must then be what it
was. Hostile calls may change neither the scene nor any file.
"""

from __future__ import annotations

import asyncio
import base64
import io
import os
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from PIL import Image

from ..agent.session.session import Session
from ..agent.toolbox.toolbox import Toolbox
from ..gaussians.errors import BackendError
from ..gaussians.files import save
from ..gaussians.language.field.store import save_field
from ..gaussians.scene import Scene
from ..planners.compose.api import compose
from ._hostile_calls import Call, hostile_calls
from .harness import Metric, Result

SEED = 3
ROOM = "a living room with a sofa, two red armchairs, a coffee table and a floor lamp"
FORM: Call = ("recolor", {"target": {"text": "armchair"}, "color": "blue"})  # two match
TOLD: Call = ("do", {"instruction": "remove the armchair"})
STEPS: tuple[Call, ...] = (
    ("do", {"instruction": "make the sofa green"}),
    FORM,
    ("scale", {"target": {"text": "coffee table"}, "factor": 0.8}),
    TOLD,
    ("insert", {"asset": "ball", "color": "red", "picture": True}),
)
_BLANK = 8.0  # standard deviation of 8-bit values below which a picture counts as blank


@dataclass
class Talk:
    """What one client's session showed.

    Attributes:
        steps: edits that were carried out, of `STEPS`.
        forms: forms that the client was asked to fill in.
        told: ambiguities that were told, and then answered by a tool.
        pictures: pictures that are not blank.
        undone: whether the digest was at last what it was at first.
        seconds: of each call.
    """

    steps: int = 0
    forms: int = 0
    told: int = 0
    pictures: int = 0
    undone: bool = False
    seconds: list[float] = field(default_factory=list)

    @property
    def whole(self) -> bool:
        """Whether everything was as it must be."""
        return (self.steps, self.forms, self.told, self.pictures, self.undone) == (len(STEPS), 2, 1, 2, True)


def run(quick: bool) -> Result:
    """Serve a composed room to clients, and count."""
    metrics, notes = figures()
    title = "MCP: sessions of five edits with questions back, pictures and undo; hostile calls"
    return Result(title, "", metrics, (), notes, seeds=(SEED,))


def figures() -> tuple[tuple[Metric, ...], tuple[str, ...]]:
    """The figures and notes, for this benchmark and for others.

    Raises:
        BackendError: the package mcp is not installed.
    """
    try:
        import mcp
    except ImportError as error:
        raise BackendError("bench mcp needs the package mcp; run: pip install 'scenewright[mcp]'") from error
    from ..agent.mcp.server import SceneServer

    with tempfile.TemporaryDirectory() as scratch:
        scene, path = _room(Path(scratch) / "scenes")
        command = ["-m", "scenewright", "mcp", str(path), "--planner", "grammar"]
        stdio = mcp.StdioServerParameters(command=sys.executable, args=command, env=dict(os.environ))
        talks = {
            "memory": asyncio.run(_talk(SceneServer(_toolbox(scene, path)), "auto")),
            "memory before 2026": asyncio.run(_talk(SceneServer(_toolbox(scene, path)), "legacy")),
            "stdio": asyncio.run(_talk(stdio, "auto")),
        }
        hostile = _hostile(_toolbox(scene, path), Path(scratch))
    metrics = [
        Metric(f"session.{name}.whole", float(t.whole), "share", "higher", goal=1.0) for name, t in talks.items()
    ]
    metrics += [
        Metric(f"session.{name}.median call", 1000 * median(t.seconds), "ms", "lower", 0.5) for name, t in talks.items()
    ]
    notes = (
        "session: five edits, two of them ambiguous (one form filled in, one declined and then answered by a tool), "
        "two pictures, undone to the same digest; whole: all of it happened.",
    )
    return (*metrics, *hostile), notes


def _room(folder: Path) -> tuple[Scene, Path]:
    """A composed room and its file, with its language field beside it."""
    folder.mkdir()
    scene, path = compose(ROOM, seed=SEED).build(seed=SEED), folder / "room.ply"
    save(scene, path)
    save_field(scene, path)
    return scene, path


def _toolbox(scene: Scene, path: Path) -> Toolbox:
    return Toolbox(Session(scene, planner="grammar"), path.parent)


async def _talk(server: Any, mode: str) -> Talk:
    """A client's session; `server` is what `mcp.Client` takes."""
    from mcp import Client
    from mcp.types import ElicitResult

    talk = Talk()

    async def fill(context: Any, params: Any) -> ElicitResult:
        talk.forms += 1
        return (
            ElicitResult(action="accept", content={"choice": "1"})
            if talk.forms == 1
            else ElicitResult(action="decline")
        )

    async with Client(server, mode=mode, elicitation_callback=fill, read_timeout_seconds=120) as client:

        async def call(name: str, arguments: dict[str, Any]) -> Any:
            started = time.perf_counter()
            result = await client.call_tool(name, arguments)
            talk.seconds.append(time.perf_counter() - started)
            talk.pictures += sum(
                not _blank(b.data) for b in result.content if b.type == "image" and not result.is_error
            )
            return result

        first = (await call("render", {"width": 320})).structured_content["scene"]
        for name, arguments in STEPS:
            result = await call(name, arguments)
            if result.structured_content["verdict"] == "ambiguous":  # the client declined
                talk.told += 1
                result = await call("answer", {"answer": "1"})
            talk.steps += not result.is_error
        undone = await call("undo", {"steps": result.structured_content["scene"]["undo"]})
        talk.undone = undone.structured_content["scene"] == first
    return talk


def _blank(image: str) -> bool:
    """Whether a picture, as base64, shows nothing."""
    return float(np.asarray(Image.open(io.BytesIO(base64.b64decode(image))).convert("L")).std()) < _BLANK


def _hostile(toolbox: Toolbox, scratch: Path) -> list[Metric]:
    """Counts of hostile calls, and of what they changed."""
    from mcp import Client, MCPError

    from ..agent.mcp.server import SceneServer

    (scratch / "outside").mkdir()
    (scratch / "scenes" / "link").symlink_to(scratch / "outside")
    calls = hostile_calls(toolbox, group=1)
    first, files = toolbox.state(), _files(scratch)
    changed = internal = 0

    async def work() -> None:
        nonlocal changed, internal
        async with Client(SceneServer(toolbox), read_timeout_seconds=60) as client:
            for name, arguments in calls:
                try:
                    result = await client.call_tool(name, arguments)
                except (MCPError, ValueError):  # refused by the protocol, before a tool is called
                    continue
                changed += toolbox.state()["digest"] != first["digest"]
                internal += (result.structured_content or {}).get("verdict") == "internal"

    asyncio.run(work())
    return [
        Metric("hostile.calls", len(calls), "count", "higher", goal=200),
        Metric("hostile.scene changed", changed, "count", "lower", goal=0),
        Metric("hostile.files touched", len(files ^ _files(scratch)), "count", "lower", goal=0),
        Metric("hostile.internal errors", internal, "count", "lower", goal=0),
    ]


def _files(folder: Path) -> set[tuple[str, int, int]]:
    """Name, size and time of each entry below a folder."""
    stats = ((p, p.lstat()) for p in folder.rglob("*"))
    return {(str(p.relative_to(folder)), s.st_size, s.st_mtime_ns) for p, s in stats}
