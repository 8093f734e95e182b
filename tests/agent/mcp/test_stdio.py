"""`scenewright mcp` as a client starts it: over stdin and stdout of another process, and without the package."""

from __future__ import annotations

import asyncio
import base64
import io
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from scenewright.agent import cli
from scenewright.gaussians.files import save
from scenewright.gaussians.language.field.store import save_field
from scenewright.gaussians.scene import Scene


@pytest.mark.slow
def test_a_session_over_stdio(named_boxes: Scene, tmp_path: Path) -> None:
    """Five edits, an ambiguity by a form and told, a picture, hostile lines, undone to the same digest."""
    mcp = pytest.importorskip("mcp", reason="needs the extra `mcp`")
    from mcp.types import ElicitResult

    folder = tmp_path / "scenes"
    folder.mkdir()
    save(named_boxes, folder / "boxes.ply")
    save_field(named_boxes, folder / "boxes.ply")
    files = sorted(p.name for p in folder.iterdir())
    server = mcp.StdioServerParameters(
        command=sys.executable,
        args=["-m", "scenewright", "mcp", str(folder / "boxes.ply"), "--planner", "grammar"],
        env=dict(os.environ),
        cwd=tmp_path,
    )
    forms: list[str] = []

    async def fill(context: Any, params: Any) -> ElicitResult:
        forms.append(params.message)
        if len(forms) > 1:
            return ElicitResult(action="decline")
        return ElicitResult(action="accept", content={"choice": "the right one"})

    async def work() -> None:
        async with mcp.Client(server, elicitation_callback=fill, read_timeout_seconds=60) as client:

            async def call(tool: str, **arguments: Any) -> Any:
                return await client.call_tool(tool, arguments)

            first = (await call("render", width=96)).structured_content["scene"]
            assert not (await call("do", instruction="make the green box blue")).is_error
            chosen = await call("do", instruction="delete the red box")
            assert chosen.structured_content["receipts"][0]["selection"]["groups"] == [2]
            undeclared = await call("delete", target={"text": "box"})  # declined, so told
            assert undeclared.is_error and undeclared.structured_content["verdict"] == "ambiguous"
            assert not (await call("answer", answer="the left one")).is_error
            assert not (await call("insert", asset="chair")).is_error
            seen = await call("scale", target={"text": "box"}, factor=0.5, picture=True)
            images = [block for block in seen.content if block.type == "image"]
            picture = Image.open(io.BytesIO(base64.b64decode(images[0].data)))
            assert picture.width > 90 and len(picture.convert("RGB").getcolors(1_000_000) or []) > 50
            assert (await call("save", file="../boxes.ply", force=True)).is_error
            assert seen.structured_content["scene"]["undo"] == 5
            undone = await call("undo", steps=5)
            assert undone.structured_content["scene"] == first

    asyncio.run(work())
    assert len(forms) == 2 and "red" in forms[0]
    assert sorted(p.name for p in folder.iterdir()) == files and sorted(tmp_path.iterdir()) == [folder]


def test_without_the_package_the_error_says_what_to_install(
    named_boxes: Scene,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    uninstalled: Callable[[str], None],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    save(named_boxes, tmp_path / "boxes.ply")
    for name in [m for m in sys.modules if m.split(".")[0] == "mcp" or m.startswith("scenewright.agent.mcp.")]:
        monkeypatch.delitem(sys.modules, name)
    uninstalled("mcp.server.mcpserver")
    with pytest.raises(SystemExit) as stopped:
        cli.main(["mcp", str(tmp_path / "boxes.ply")])
    assert stopped.value.code == 4
    streams = capsys.readouterr()
    assert not streams.out and "pip install 'scenewright[mcp]'" in streams.err


def test_a_port_that_is_taken_is_told(named_boxes: Scene, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mcp", reason="needs the extra `mcp`")
    import socket

    save(named_boxes, tmp_path / "boxes.ply")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(SystemExit) as stopped:
            cli.main(["mcp", str(tmp_path / "boxes.ply"), "--http", str(taken.getsockname()[1])])
    assert stopped.value.code == 2 and "choose another one" in capsys.readouterr().err
