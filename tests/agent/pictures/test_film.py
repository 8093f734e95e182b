"""Films on disk: whole or not at all, the same bytes twice, and an ffmpeg that is missing, fails, lies or hangs."""

from __future__ import annotations

import stat
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image, ImageSequence

from scenewright.agent.pictures import film
from scenewright.gaussians.errors import BackendError, FileError, UserError

NAMES = tuple(f"{i:04d}" for i in range(5))
W, H = 24, 16


def draw(i: int) -> Any:
    """A white column that walks over a slope of red."""
    picture = np.zeros((H, W, 3), np.uint8)
    picture[..., 0] = np.linspace(0, 250, W)
    picture[:, i] = 255
    return picture


def interrupted(i: int) -> Any:
    if i == 3:
        raise KeyboardInterrupt
    return draw(i)


def files(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.rglob("*"))


def test_a_folder_of_pictures(tmp_path: Path) -> None:
    size = film.write(tmp_path / "made" / "film", NAMES, draw, 25.0, False)
    assert files(tmp_path / "made" / "film") == [f"{n}.png" for n in NAMES] and files(tmp_path / "made")[-1] == "film"
    assert size == sum(p.stat().st_size for p in (tmp_path / "made" / "film").iterdir())
    for i, name in enumerate(NAMES):
        assert np.array_equal(np.asarray(Image.open(tmp_path / "made" / "film" / f"{name}.png")), draw(i))


def test_a_pattern_goes_among_other_files(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("kept")
    film.write(tmp_path / "a%02d.png", NAMES, draw, 25.0, False)
    assert files(tmp_path) == [*(f"a{i:02d}.png" for i in range(5)), "mine.txt"]
    with pytest.raises(UserError, match="exists"):
        film.check(tmp_path / "a%02d.png", NAMES, {(W, H)}, 25.0, False)
    film.check(tmp_path / "a%02d.png", NAMES, {(W, H)}, 25.0, True)


@pytest.mark.parametrize("output", ["film", "a%d.png", "film.gif"])
def test_an_interrupt_leaves_nothing(tmp_path: Path, output: str) -> None:
    with pytest.raises(KeyboardInterrupt):
        film.write(tmp_path / output, NAMES, interrupted, 25.0, False)
    assert files(tmp_path) == []


@pytest.mark.parametrize("output", ["film", "film.gif"])
def test_with_force_an_interrupt_leaves_what_was_there(tmp_path: Path, output: str) -> None:
    film.write(tmp_path / output, NAMES, draw, 25.0, False)
    before = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    with pytest.raises(KeyboardInterrupt):
        film.write(tmp_path / output, NAMES, lambda i: interrupted(i) // 2, 25.0, True)
    assert {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()} == before


def test_a_file_that_appears_meanwhile_is_kept(tmp_path: Path) -> None:
    def late(i: int) -> Any:
        if i == 4:
            (tmp_path / "0001.png").write_text("somebody else's")
        return draw(i)

    with pytest.raises(UserError, match="exists"):
        film.write(tmp_path, NAMES, late, 25.0, False)
    assert files(tmp_path) == ["0001.png"]


def test_a_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises((UserError, FileError)):
        film.write(tmp_path / "file" / "film", NAMES, draw, 25.0, False)


def test_a_gif_shows_its_pictures_in_time_and_for_ever(tmp_path: Path) -> None:
    film.write(tmp_path / "a.gif", NAMES, draw, 30.0, False)
    image = Image.open(tmp_path / "a.gif")
    frames = [(np.asarray(f.convert("RGB")).astype(int), f.info["duration"]) for f in ImageSequence.Iterator(image)]
    assert image.info["loop"] == 0 and [d for _, d in frames] == [30, 40, 30, 30, 40]  # 5 / 30 s in hundredths
    for i, (shown, _) in enumerate(frames):
        assert np.abs(shown - draw(i)).max() <= 4  # few colours: the palette holds nearly all of them


def test_the_same_pictures_have_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a.gif", "b.gif", "a", "b"):
        film.write(tmp_path / name, NAMES, draw, 25.0, False)
    assert (tmp_path / "a.gif").read_bytes() == (tmp_path / "b.gif").read_bytes()
    assert (tmp_path / "a" / "0003.png").read_bytes() == (tmp_path / "b" / "0003.png").read_bytes()


def test_a_gif_draws_every_picture_once(tmp_path: Path) -> None:
    drawn: list[int] = []
    film.write(tmp_path / "a.gif", [""] * 40, lambda i: drawn.append(i) or draw(i % W), 25.0, False)  # type: ignore[func-returns-value]
    assert sorted(drawn) == list(range(40))


def test_a_gif_of_one_picture(tmp_path: Path) -> None:
    film.write(tmp_path / "a.gif", ["0"], draw, 25.0, False)
    assert Image.open(tmp_path / "a.gif").size == (W, H)


@pytest.mark.parametrize(
    ("output", "sizes", "fps", "says"),
    [
        ("a.gif", {(W, H)}, 60.0, "at most 50"),
        ("a.gif", {(8192, 8192), (1, 1)}, 25.0, "one size"),
        ("a.gif", {(8192 * 4, 8192)}, 25.0, "too much"),
        ("%d%d.png", {(W, H)}, 25.0, "is not a pattern"),
        ("100%_%d.png", {(W, H)}, 25.0, "is not a pattern"),
    ],
)
def test_what_does_not_suit_the_format_is_refused(
    tmp_path: Path, output: str, sizes: set[tuple[int, int]], fps: float, says: str
) -> None:
    with pytest.raises(UserError, match=says):
        film.check(tmp_path / output, NAMES, sizes, fps, False)


def ffmpeg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, body: str) -> None:
    """A program of that name, in Python, that is the only one on the path."""
    program = tmp_path / "bin" / "ffmpeg"
    program.parent.mkdir()
    program.write_text(f"#!{sys.executable} -S\nimport sys, time\n{body}\n")
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(program.parent))


def test_an_mp4_is_what_ffmpeg_made_of_all_the_pictures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ffmpeg(
        tmp_path, monkeypatch, "open(sys.argv[-1], 'wb').write(repr(sys.argv[1:-1]).encode() + sys.stdin.buffer.read())"
    )
    film.check(tmp_path / "a.mp4", NAMES, {(W, H)}, 12.5, False)
    film.write(tmp_path / "a.mp4", NAMES, draw, 12.5, False)
    made = (tmp_path / "a.mp4").read_bytes()
    assert made.endswith(b"".join(draw(i).tobytes() for i in range(5)))
    assert b"'-s', '24x16', '-r', '12.5'" in made and b"yuv420p" in made


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("sys.stdin.buffer.read(10); print('no such encoder', file=sys.stderr); sys.exit(1)", "no such encoder"),
        ("sys.stdin.buffer.read(); print('disk full', file=sys.stderr); sys.exit(1)", "disk full"),
        ("sys.exit(3)", "gave no reason"),
        ("sys.stdin.buffer.read()", "gave no reason"),  # it claims to have done it, and wrote nothing
        ("time.sleep(60)", "took nothing"),
        ("sys.stdin.buffer.read(); time.sleep(60)", "took nothing"),
    ],
)
def test_an_ffmpeg_that_fails_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, body: str, says: str
) -> None:
    ffmpeg(tmp_path, monkeypatch, body)
    monkeypatch.setattr(film, "_FFMPEG_TIMEOUT", 0.5)
    big = np.zeros((300, 400, 3), np.uint8)  # more than a pipe holds
    with pytest.raises(BackendError, match=says):
        film.write(tmp_path / "a.mp4", NAMES, lambda i: big, 25.0, False)
    assert files(tmp_path) == ["bin", "ffmpeg"]


def test_an_interrupt_ends_ffmpeg_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ffmpeg(tmp_path, monkeypatch, "open(sys.argv[-1], 'wb').write(b'half'); sys.stdin.buffer.read(); time.sleep(60)")
    with pytest.raises(KeyboardInterrupt):
        film.write(tmp_path / "a.mp4", NAMES, interrupted, 25.0, False)
    assert files(tmp_path) == ["bin", "ffmpeg"]


def test_without_ffmpeg_an_mp4_is_refused_before_the_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BackendError, match=r"install it .* or write \.gif"):
        film.check(tmp_path / "a.mp4", NAMES, {(W, H)}, 25.0, False)


def test_an_ffmpeg_that_cannot_start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ffmpeg(tmp_path, monkeypatch, "")
    (tmp_path / "bin" / "ffmpeg").write_text("#!/nowhere/at/all\n")
    with pytest.raises(BackendError, match="cannot be started"):
        film.write(tmp_path / "a.mp4", NAMES, draw, 25.0, False)


def test_an_mp4_of_odd_size_is_refused_with_one_that_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ffmpeg(tmp_path, monkeypatch, "")
    with pytest.raises(UserError, match="--size 26x16"):
        film.check(tmp_path / "a.mp4", NAMES, {(25, 16)}, 25.0, False)
