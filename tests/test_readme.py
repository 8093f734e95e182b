"""What the README promises: its Python runs, its commands exist, its links and pictures are there."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import typer.main

from scenewright.agent import cli

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def _blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def _commands() -> list[list[str]]:
    import shlex

    lines = [line for block in _blocks("sh") for line in block.replace("\\\n", "").splitlines()]
    lines += re.findall(r"`(scenewright [^`]+)`", README.replace("\n", " "))
    return [shlex.split(line, comments=True)[1:] for line in lines if line.startswith("scenewright ")]


@pytest.mark.parametrize("words", _commands(), ids=" ".join)
def test_commands_and_their_options_exist(words: list[str]) -> None:
    verb = words[0]
    assert verb in cli.VERBS
    known = {option for p in typer.main.get_command(cli.command_line()).commands[verb].params for option in p.opts}  # type: ignore[attr-defined]
    assert {w for w in words if w.startswith("-")} <= known


def test_links_and_pictures_are_there() -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", README):
        assert (ROOT / target).is_file(), target
    for image in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", README):
        assert (ROOT / image).stat().st_size < 300_000


def test_make_targets_exist() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    said = [
        *re.findall(r"`make (\w+)", README),
        *re.findall(r"^make (\w+)", "".join(_blocks("sh")), flags=re.MULTILINE),
    ]
    assert {"demo", "test"} <= set(said)
    for target in said:
        assert re.search(rf"^{target}:", makefile, flags=re.MULTILINE), target


def test_documents_say_nothing_of_the_machine_they_were_written_on() -> None:
    for path in (ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").glob("*.md")):
        assert not re.search(r"(^|[\s`(\"'])/(work|tmp|root|home)/", path.read_text(encoding="utf-8")), path


@pytest.mark.slow
def test_the_python_of_the_readme_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a small room that holds what it speaks of."""
    (code,) = _blocks("python")
    _room_of_the_readme(tmp_path / "room.ply")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(compile(code, "README.md", "exec"), names)  # our own document
    assert names["found"].verdict == "found"
    assert names["picture"].ndim == 3 and (tmp_path / "out.ply").is_file() and (tmp_path / "session.jsonl").is_file()


def _room_of_the_readme(path: Path) -> None:
    """An armchair, a coffee table and a floor lamp, well apart on a grey floor, and a camera before them."""
    import torch

    import scenewright as sw
    from scenewright.gaussians.cloud import concat

    steps = torch.linspace(-3, 3, 80)
    means = torch.cartesian_prod(steps, steps, torch.zeros(1))
    flat = torch.tensor([0.05, 0.05, 0.004]).expand(len(means), 3).contiguous()
    upright = torch.tensor([1.0, 0, 0, 0]).expand(len(means), 4).contiguous()
    grey = torch.zeros(len(means), 1, 3)
    clouds = [sw.GaussianCloud.create(means, upright, flat, torch.full((len(means),), 0.95), grey)]
    for kind, x in (("armchair", -1.8), ("coffee table", 0.0), ("floor lamp", 1.8)):
        cloud = sw.make(kind, seed=1).cloud
        first = sum(len(c) for c in clouds)
        ids = torch.arange(first, first + len(cloud))
        clouds.append(cloud.replace(means=cloud.means + torch.tensor([x, 0.0, 0.0]), ids=ids))
    camera = sw.Camera.look_at([0, -5, 2], [0, 0, 0.6], [0, 0, 1], 320, 240, 55)
    frame = sw.Frame((0, 0, 1), 0.0, 1.0, "given", "given")
    sw.save(sw.Scene(concat(clouds), frame, (camera,)), path)


def _demo_examples() -> list[list[str]]:
    """The README's commands on the room that `make demo` writes; chat is left out, as it waits for a person."""
    return [words for words in _commands() if "demo/room.ply" in words and words[0] != "chat"]


@pytest.mark.slow
def test_the_examples_on_the_demo_room_do_what_they_say(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """On the very scene that they name, in the order in which they stand there."""
    import scenewright as sw

    (tmp_path / "demo").mkdir()
    monkeypatch.chdir(tmp_path)
    seed = re.search(r"^SEED \?= (\d+)$", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert seed is not None
    sw.save(sw.furnish(int(seed[1])).scene, tmp_path / "demo" / "room.ply")  # as `make demo` does
    examples = _demo_examples()
    assert len(examples) >= 6
    for words in examples:
        with pytest.raises(SystemExit) as ended:
            cli.main(words)
        said = capsys.readouterr()
        assert ended.value.code in (0, None), f"{' '.join(words)}: {said.err}"
    assert (tmp_path / "out.ply").is_file() and (tmp_path / "rows.npy").is_file()
