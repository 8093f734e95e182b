"""A language field on disk: exact, bound to its scene file, and never trusted when damaged."""

from __future__ import annotations

import json
import os
import stat
from contextlib import AbstractContextManager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from safetensors import safe_open

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import FileError
from scenewright.gaussians.files import atomic
from scenewright.gaussians.files.fingerprint import fingerprint
from scenewright.gaussians.language.field import store
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.field.making import Making, MaskSource
from scenewright.gaussians.language.field.store import (
    cached_field_path,
    field_path,
    load_field,
    mismatch,
    save_field,
)
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box

numbers = st.floats(-1e6, 1e6)
vectors = st.tuples(numbers, numbers, numbers)
words = st.text(max_size=12)
shares = st.floats(0, 1)
votes = st.lists(st.tuples(words, shares), max_size=3).map(tuple)
makings = st.builds(
    Making, words, st.lists(st.builds(MaskSource, words, agreement=st.none() | shares), max_size=2).map(tuple),
    st.integers(0, 99), st.integers(0, 99), words, words,
)  # fmt: skip


@st.composite
def fields(draw: st.DrawFn) -> LanguageField:
    count, dim = draw(st.integers(0, 4)), draw(st.integers(1, 3))
    groups = tuple(
        Group(
            i, draw(st.sampled_from(["object", "part", "structure"])), draw(st.integers(-1, count - 1)), draw(words),
            draw(st.floats(0, 1)), Box(draw(vectors), (draw(vectors), draw(vectors), draw(vectors)), draw(vectors)),
            draw(vectors), draw(st.integers(0, 10**9)), draw(st.integers(0, 24)), draw(st.floats(0, 1)),
            names=draw(votes), votes=draw(votes), rests=draw(st.sampled_from(["", "floor", "wall"])),
        )
        for i in range(count)
    )  # fmt: skip
    embeddings = draw(st.lists(st.floats(-1, 1, width=32), min_size=count * dim, max_size=count * dim))
    table = np.array(embeddings, np.float32).reshape(count, dim)
    notes = tuple(draw(st.lists(words, max_size=2)))
    return LanguageField(groups, table, draw(words), notes, draw(st.none() | makings))


frames = st.builds(
    Frame, st.sampled_from([(0.0, 0.0, 1.0), (0.1, -0.9, 0.3), (-1.0, 2.0, 0.7)]), st.none() | numbers,
    st.none() | st.floats(1e-3, 1e3), st.sampled_from(["given", "file", "estimated", "unknown"]),
)  # fmt: skip


def bare(count: int = 5) -> Scene:
    cloud = GaussianCloud.create(
        torch.zeros(count, 3), torch.tensor([[1.0, 0, 0, 0]]).repeat(count, 1), torch.ones(count, 3),
        torch.full((count,), 0.5), torch.zeros(count, 1, 3),
    )  # fmt: skip
    return Scene(cloud)


def embedded(encoder: str = "fake:1") -> Scene:
    box = Box((0, 0, 0.5), ((1, 0, 0), (0, 1, 0), (0, 0, 1)), (1, 1, 1))
    groups = (
        Group(0, "object", -1, "chair", 0.9, box, (50, 10, -3), 3, 2, 0.8),
        Group(1, "part", 0, "", 0.0, box, (20, 0, 0), 1, 2, 0.8),
    )
    field = LanguageField(groups, np.eye(2, 3, dtype=np.float32), encoder, ("a note",))
    scene = bare()
    group = torch.tensor([0, 0, 1, -1, 0], dtype=torch.int32)
    return scene.replace(cloud=scene.cloud.replace(group=group), language=field, frame=Frame(floor=0.1))


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A scene file of some bytes, and a cache folder of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    folder = tmp_path / "scenes"
    folder.mkdir()
    (folder / "room.ply").write_bytes(b"a scene")
    return folder / "room.ply"


def same(one: Scene, other: Scene) -> bool:
    a, b = one.language, other.language
    assert a is not None and b is not None
    return (
        torch.equal(one.cloud.group, other.cloud.group)
        and a.groups == b.groups
        and a.embeddings.dtype == b.embeddings.dtype
        and np.array_equal(a.embeddings, b.embeddings)
        and (a.encoder, a.notes, a.making) == (b.encoder, b.notes, b.making)
    )


def test_a_saved_field_comes_back_beside_the_scene(path: Path) -> None:
    scene = embedded()
    assert save_field(scene, path) == field_path(path)
    again = load_field(bare(), path)
    assert again is not None and same(scene, again)
    assert again.frame == scene.frame
    assert sorted(p.name for p in path.parent.iterdir()) == ["room.ply", field_path(path).name]  # no leftovers


@given(field=fields(), frame=frames)
def test_the_round_trip_is_exact(tmp_path_factory: pytest.TempPathFactory, field: LanguageField, frame: Frame) -> None:
    target = tmp_path_factory.mktemp("exact") / "scene.ply"
    target.write_bytes(b"x")
    column = torch.tensor([i % (len(field.groups) + 1) - 1 for i in range(5)], dtype=torch.int32)
    scene = bare()
    scene = scene.replace(cloud=scene.cloud.replace(group=column), language=field, frame=frame)
    save_field(scene, target)
    again = load_field(bare(), target)
    assert again is not None and same(scene, again)
    assert again.frame.up == pytest.approx(frame.up, abs=1e-15)  # a unit vector is made unit again
    assert (again.frame.floor, again.frame.metres_per_unit) == (frame.floor, frame.metres_per_unit)
    assert (again.frame.up_source, again.frame.scale_source) == (frame.up_source, frame.scale_source)


@given(field=fields(), frame=frames)
def test_a_packed_field_is_exact_too(
    tmp_path_factory: pytest.TempPathFactory, field: LanguageField, frame: Frame
) -> None:
    target = tmp_path_factory.mktemp("packed") / "scene.ply"
    target.write_bytes(b"x")
    column = torch.tensor([i % (len(field.groups) + 1) - 1 for i in range(5)], dtype=torch.int32)
    scene = bare()
    scene = scene.replace(cloud=scene.cloud.replace(group=column), language=field, frame=frame)
    save_field(scene, target, packed=True)
    again = load_field(bare(), target)
    assert again is not None and same(scene, again)
    assert mismatch(target) is None


def test_a_packed_field_takes_fewer_bytes(path: Path) -> None:
    scene = embedded()
    assert scene.language is not None
    many = torch.arange(4000, dtype=torch.int32) // 2000
    large = replace(scene, cloud=bare(4000).cloud.replace(group=many))
    plain = len(save_field(large, path).read_bytes())
    assert len(save_field(large, path, packed=True).read_bytes()) < plain / 8


@pytest.mark.parametrize(
    "how",
    [
        {"drop": "table"}, {"drop": "planes"}, {"drop": "encoded"}, {"drop": "vectors"}, {"drop": "groups_listed"},
        {"groups_listed": 5}, {"groups_listed": "no"}, {"tensors": {"planes": torch.zeros(9, dtype=torch.uint8)}},
        {"tensors": {"table": torch.zeros(9, dtype=torch.uint8)}}, {"tensors": {"vectors": torch.zeros(2)}},
        {"tensors": {"encoded": torch.tensor([0, 9], dtype=torch.int32)}},
        {"tensors": {"vectors": torch.full((2, 3), torch.nan)}},
    ],
    ids=lambda how: ",".join(f"{k}={v}"[:40] for k, v in how.items()),
)  # fmt: skip
def test_a_damaged_packed_field_is_a_file_error(path: Path, how: dict[str, Any]) -> None:
    damaged(path, packed=True, **how)
    with pytest.raises(FileError, match="damaged"):
        load_field(bare(), path)


def test_a_packed_field_of_another_number_of_gaussians_is_damaged(path: Path) -> None:
    save_field(embedded(), path, packed=True)
    for count in (4, 6):
        with pytest.raises(FileError, match="damaged"):
            load_field(bare(count), path)


def test_the_same_field_is_the_same_bytes(path: Path) -> None:
    first = save_field(embedded(), path).read_bytes()
    assert save_field(embedded(), path).read_bytes() == first


def test_a_changed_scene_file_has_no_field(path: Path) -> None:
    save_field(embedded(), path)
    path.write_bytes(b"another scene")
    assert load_field(bare(), path) is None
    save_field(embedded(), path)  # made again, it replaces the stale one
    assert load_field(bare(), path) is not None


def test_a_field_of_another_encoder_does_not_fit(path: Path) -> None:
    save_field(embedded("fake:1"), path)
    assert load_field(bare(), path, "fake:2") is None
    assert load_field(bare(), path, "fake:1") is not None
    assert load_field(bare(), path) is not None


def test_a_scene_without_a_field(path: Path) -> None:
    assert load_field(bare(), path) is None
    with pytest.raises(FileError, match="embed it first"):
        save_field(bare(), path)


def test_a_moved_scene_keeps_what_was_cached_for_its_content(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    refuse(monkeypatch, path.parent)
    saved = save_field(embedded(), path)
    assert saved == cached_field_path(fingerprint(path)) and saved.is_file()
    elsewhere = path.parent.parent / "moved.ply"
    path.rename(elsewhere)
    again = load_field(bare(), elsewhere)
    assert again is not None and same(embedded(), again)


def test_of_two_fields_that_fit_the_one_written_last_is_meant(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    os.utime(save_field(embedded("fake:1"), path), ns=(1, 1))
    refuse(monkeypatch, path.parent)
    assert save_field(embedded("fake:2"), path) == cached_field_path(fingerprint(path))
    again = load_field(bare(), path)
    assert again is not None and again.language is not None and again.language.encoder == "fake:2"


def refuse(monkeypatch: pytest.MonkeyPatch, *folders: Path) -> None:
    """Nothing can be made in these folders; permissions alone would not stop an administrator."""
    make = store.writing

    def writing(target: Path, force: bool) -> AbstractContextManager[BinaryIO]:
        if any(f in target.parents for f in folders):
            raise FileError(f"cannot write {target}: Permission denied")
        return make(target, force)

    monkeypatch.setattr(store, "writing", writing)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="an administrator may write anywhere")
def test_a_read_only_folder_sends_the_field_to_the_cache(path: Path) -> None:
    path.parent.chmod(0o500)
    try:
        assert save_field(embedded(), path) == cached_field_path(fingerprint(path))
        assert load_field(bare(), path) is not None
    finally:
        path.parent.chmod(0o700)


def test_where_nothing_can_be_written_the_error_says_so(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    refuse(monkeypatch, path.parent.parent)
    with pytest.raises(FileError, match="cannot save"):
        save_field(embedded(), path)


def test_a_failed_write_leaves_the_old_field_and_no_crumbs(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    saved = save_field(embedded(), path)
    before = saved.read_bytes()

    def full(handle: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(atomic.os, "fsync", full)
    with pytest.raises(KeyboardInterrupt):
        save_field(embedded("fake:2"), path)
    assert saved.read_bytes() == before
    assert sorted(p.name for p in path.parent.iterdir()) == ["room.ply", saved.name]


@pytest.mark.skipif(os.name != "posix", reason="permission bits of POSIX")
def test_a_field_is_as_readable_as_any_new_file(path: Path) -> None:
    plain = path.parent / "plain"
    plain.write_bytes(b"")
    saved = save_field(embedded(), path)
    assert stat.S_IMODE(saved.stat().st_mode) == stat.S_IMODE(plain.stat().st_mode)


@pytest.mark.parametrize("share", [0.0, 0.002, 0.3, 0.9, 0.999])
def test_a_truncated_field_is_an_error_that_names_the_cure(path: Path, share: float) -> None:
    saved = save_field(embedded(), path)
    whole = saved.read_bytes()
    saved.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(FileError, match="delete it"):
        load_field(bare(), path)


def test_a_table_nested_too_deeply_is_an_error_that_names_the_cure(path: Path) -> None:
    from safetensors.torch import save_file

    save_file({"group": torch.zeros(5)}, field_path(path), {"scenewright.field": "[" * 100_000})
    for look in (lambda: load_field(bare(), path), lambda: mismatch(path)):
        with pytest.raises(FileError, match="delete it"):
            look()


def damaged(
    path: Path, drop: str = "", tensors: dict[str, torch.Tensor] | None = None, packed: bool = False, **changes: Any
) -> None:
    """A field file bound to this scene, with parts exchanged or left out."""
    from safetensors.torch import load_file, save_file

    saved = save_field(embedded(), path, packed)
    with safe_open(saved, framework="pt") as stream:
        ((entry, text),) = stream.metadata().items()
    header, data = json.loads(text) | changes, load_file(saved) | (tensors or {})
    header.pop(drop, None)
    data.pop(drop, None)
    save_file(data, saved, {entry: json.dumps(header)})


def groups_with(**changes: Any) -> list[dict[str, Any]]:
    scene = embedded()
    assert scene.language is not None
    return [asdict(replace(g, **changes)) for g in scene.language.groups]


def test_the_undamaged_field_of_the_next_test_loads(path: Path) -> None:
    damaged(path)
    assert load_field(bare(), path) is not None


@pytest.mark.parametrize(
    "how",
    [
        {"drop": "groups"}, {"drop": "notes"}, {"drop": "making"}, {"making": {"encoder": 3}},
        {"drop": "frame"}, {"drop": "encoder"}, {"drop": "group"},
        {"drop": "embeddings"}, {"groups": [{}]}, {"groups": []}, {"groups": "no"}, {"groups": None},
        {"groups": groups_with(id=0)},
        {"groups": groups_with(parent=7)}, {"groups": groups_with(level="thing")}, {"notes": 3},
        {"frame": {"up": [0, 0, 0]}}, {"frame": {"up": "down"}},
        {"tensors": {"group": torch.tensor([0, 0, 1, -1, 2], dtype=torch.int32)}},
        {"tensors": {"group": torch.tensor([0, 0, 1, -2, 1], dtype=torch.int32)}},
        {"tensors": {"group": torch.tensor([0, 0, 1], dtype=torch.int32)}},
        {"tensors": {"group": torch.zeros(5)}},
        {"tensors": {"embeddings": torch.zeros(3, 3)}},
        {"tensors": {"embeddings": torch.zeros(2)}},
        {"tensors": {"embeddings": torch.full((2, 3), torch.nan)}},
        {"tensors": {"embeddings": torch.zeros(2, 3, dtype=torch.float64)}},
    ],
    ids=lambda how: ",".join(f"{k}={v}"[:40] for k, v in how.items()),
)  # fmt: skip
def test_a_damaged_field_is_a_file_error_and_nothing_else(path: Path, how: dict[str, Any]) -> None:
    damaged(path, **how)
    with pytest.raises(FileError, match="damaged"):
        load_field(bare(), path)


@given(st.binary(max_size=200))
def test_any_bytes_are_an_error_or_no_field(tmp_path_factory: pytest.TempPathFactory, junk: bytes) -> None:
    target = tmp_path_factory.mktemp("junk") / "scene.ply"
    target.write_bytes(b"x")
    field_path(target).write_bytes(junk)
    with pytest.raises(FileError):
        load_field(bare(), target)


def test_a_field_of_another_version_is_made_again(path: Path) -> None:
    damaged(path, version="0")
    assert load_field(bare(), path) is None


def test_a_folder_is_known_by_its_files(tmp_path: Path) -> None:
    folder = tmp_path / "sog"
    folder.mkdir()
    (folder / "meta.json").write_text("{}")
    (folder / "means.webp").write_bytes(b"1")
    first = fingerprint(folder)
    assert fingerprint(folder) == first
    (folder / "means.webp").write_bytes(b"2")
    second = fingerprint(folder)
    (folder / "means.webp").rename(folder / "other.webp")
    assert len({first, second, fingerprint(folder)}) == 3


def test_a_missing_scene_file_is_a_file_error(tmp_path: Path) -> None:
    for call in (lambda p: fingerprint(p), lambda p: load_field(bare(), p), lambda p: save_field(embedded(), p)):
        with pytest.raises(FileError, match="cannot read"):
            call(tmp_path / "nowhere.ply")


def test_why_a_field_does_not_fit_is_told(path: Path) -> None:
    assert mismatch(path) is None  # there is none
    save_field(embedded(), path)
    assert mismatch(path) is None and mismatch(path, "fake:1") is None
    assert mismatch(path, "other:2") == "is of encoder fake:1"
    path.write_bytes(path.read_bytes() + b"edited elsewhere")
    assert mismatch(path) == "was made for another version of this file"
    assert load_field(bare(), path) is None
    field_path(path).write_bytes(b"no field at all")
    with pytest.raises(FileError, match="not a language field"):
        mismatch(path)


def test_a_field_of_another_layout_says_so(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    save_field(embedded(), path)
    monkeypatch.setattr(store, "VERSION", "next")
    assert mismatch(path) == "was written by another version of scenewright"
