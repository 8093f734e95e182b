"""Streamed SOG: what is written is read again level by level, and an index that lies is refused before it costs."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from scenewright.gaussians import files
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import FileError, UserError
from scenewright.gaussians.files.fingerprint import fingerprint
from scenewright.gaussians.files.formats import streamed_sog, streamed_sog_writing
from scenewright.gaussians.files.formats.morton import morton_sorted
from scenewright.gaussians.files.formats.streamed_sog import Streamed
from scenewright.gaussians.levels.levels import Levels
from scenewright.gaussians.levels.tree import Tree, build
from scenewright.gaussians.rotations import to_matrix
from scenewright.gaussians.scene import Scene

COUNT = 900
LEVELS = (900, 450, 200)
Index = dict[str, Any]


def cloud(degree: int = 1, count: int = COUNT) -> GaussianCloud:
    g = torch.Generator().manual_seed(degree)
    quats = torch.nn.functional.normalize(torch.randn(count, 4, generator=g))
    return GaussianCloud.create(
        torch.randn(count, 3, generator=g), quats, torch.rand(count, 3, generator=g) * 0.1 + 0.01,
        torch.rand(count, generator=g) * 0.9 + 0.05, torch.randn(count, (degree + 1) ** 2, 3, generator=g) * 0.3,
    )  # fmt: skip


def tree(whole: GaussianCloud) -> Tree:
    return build(whole.means.numpy(), leaf_rows=130)


def write(path: Path, degree: int = 1, chunk_rows: int = 300, force: bool = False) -> Path:
    whole = cloud(degree)
    streamed_sog_writing.save(Levels(tuple(whole[:count] for count in LEVELS), tree(whole)), path, force, chunk_rows)
    return path


def matched(found: GaussianCloud, wanted: GaussianCloud) -> GaussianCloud:
    """The rows of `found` in the order of `wanted`, by position; each exactly once."""
    distance = torch.cdist(wanted.means, found.means)
    rows = distance.argmin(dim=1)
    assert len(set(rows.tolist())) == len(wanted) == len(found)
    return found[rows]


@pytest.mark.parametrize("degree", [0, 2])
def test_each_level_comes_back_with_the_precision_of_sog(tmp_path: Path, degree: int) -> None:
    streamed = Streamed.open(write(tmp_path / "a.lod", degree))
    assert streamed.counts == LEVELS and streamed.levels == 3
    whole = cloud(degree)
    for k, count in enumerate(LEVELS):
        got, rows = streamed.level(k)
        want = whole[:count]
        got = matched(got, want)
        assert rows == count and got.degree == degree
        assert torch.allclose(got.means, want.means, atol=2e-4)  # 16 bits of a logarithm over some eight units
        assert (1 - (got.quats * want.quats).sum(dim=1).abs()).max() < 1e-4  # components in 8 bits
        # Chunks of at most 300 rows have codebooks with a value for each row of one column, and fewer for three.
        assert torch.allclose(got.scales.log(), want.scales.log(), atol=0.05)
        assert torch.allclose(got.opacities, want.opacities, atol=0.51 / 255)
        assert torch.allclose(got.sh[:, 0], want.sh[:, 0], atol=0.05)


def test_one_leaf_is_the_same_as_a_sog_file(tmp_path: Path) -> None:
    """A scene that fits one leaf and one chunk loses exactly what the same scene loses as .sog."""
    whole = cloud()
    streamed_sog_writing.save(Levels((whole,), build(whole.means.numpy())), tmp_path / "a.lod")
    files.save(Scene(whole), tmp_path / "a.sog")
    assert files.load(tmp_path / "a.lod").cloud.digest() == files.load(tmp_path / "a.sog").cloud.digest()


def test_the_finest_level_is_a_scene(tmp_path: Path) -> None:
    path = write(tmp_path / "a.lod")
    scene, report = files.load_with_report(path)
    assert report.format == "Streamed SOG" and report.rows == report.loaded == COUNT and not report.notes
    assert scene.cloud.ids.tolist() == list(range(COUNT))
    assert files.load(path / "lod-meta.json").cloud.digest() == scene.cloud.digest()


def test_leaves_are_chosen_one_by_one(tmp_path: Path) -> None:
    streamed = Streamed.open(write(tmp_path / "a.lod"))
    every = [streamed.level(k)[0] for k in range(3)]
    assert len(streamed.leaves) == 8
    levels = [i % 3 for i in range(8)]
    found = streamed.chosen(levels)
    want = sum(leaf.runs[k].count for leaf, k in zip(streamed.leaves, levels, strict=True))
    assert len(found) == want and found.ids.tolist() == list(range(want))
    start = 0
    for leaf, k in zip(streamed.leaves, levels, strict=True):  # every row lies in its leaf, and in its level
        part = found[start : start + leaf.runs[k].count]
        start += len(part)
        assert (part.means >= torch.tensor(leaf.low) - 1e-3).all() and (
            part.means <= torch.tensor(leaf.high) + 1e-3
        ).all()
        assert {tuple(m) for m in part.means.tolist()} <= {tuple(m) for m in every[k].means.tolist()}


def test_only_needed_chunks_are_read(tmp_path: Path) -> None:
    path = write(tmp_path / "a.lod")
    for folder in (*path.glob("0_*"), *path.glob("1_*")):
        shutil.rmtree(folder)
    streamed = Streamed.open(path)
    assert len(streamed.chosen([2] * 8)) == LEVELS[2]
    with pytest.raises(FileError, match=r"0_0/meta.json is missing; copy the whole folder"):
        files.load(path)


def test_the_index_says_what_the_specification_asks(tmp_path: Path) -> None:
    whole = cloud()
    index = json.loads((write(tmp_path / "a.lod") / "lod-meta.json").read_text())
    assert index["version"] == 1 and index["lodLevels"] == 3 and index["counts"] == list(LEVELS)
    assert index["count"] == sum(LEVELS)
    spread = (to_matrix(whole.quats) * whole.scales[:, None]).norm(dim=2)
    leaf_of = tree(whole).leaf_of(whole.means.numpy())
    leaves: list[Index] = []

    def walk(node: Index) -> None:
        assert ("children" in node) != ("lods" in node)
        for child in node.get("children", ()):
            walk(child)
        if "children" in node:
            left, right = (child["bound"] for child in node["children"])
            assert node["bound"]["min"] == [min(a, b) for a, b in zip(left["min"], right["min"], strict=True)]
            assert node["bound"]["max"] == [max(a, b) for a, b in zip(left["max"], right["max"], strict=True)]
        else:
            leaves.append(node)

    walk(index["tree"])
    for number, leaf in enumerate(leaves):
        inside = torch.from_numpy(leaf_of == number)
        low, high = (whole.means - spread)[inside].amin(dim=0), (whole.means + spread)[inside].amax(dim=0)
        assert np.allclose(leaf["bound"]["min"], low, rtol=1e-6) and np.allclose(leaf["bound"]["max"], high, rtol=1e-6)
    sizes = [json.loads((tmp_path / "a.lod" / name).read_text())["count"] for name in index["filenames"]]
    assert max(sizes) <= 300 and sum(sizes) == sum(LEVELS)


def test_runs_follow_a_morton_curve(tmp_path: Path) -> None:
    whole = cloud()
    streamed_sog_writing.save(Levels((whole,), build(whole.means.numpy())), tmp_path / "a.lod")
    got = files.load(tmp_path / "a.lod").cloud.means
    assert torch.allclose(got, morton_sorted(Scene(whole)).cloud.means, atol=2e-4)


def test_an_environment_is_always_there(tmp_path: Path) -> None:
    path = write(tmp_path / "a.lod")
    shutil.copytree(path / "2_0", path / "env")
    change(path, lambda index: index.update(environment="env/meta.json"))
    streamed = Streamed.open(path)
    assert len(files.load(path).cloud) == COUNT + LEVELS[2]
    assert len(streamed.chosen([1] * 8)) == LEVELS[1] + LEVELS[2]
    assert streamed.counts == LEVELS


def test_files_from_before_versions_are_read(tmp_path: Path) -> None:
    path = write(tmp_path / "a.lod")

    def older(index: Index) -> None:
        for name in ("version", "asset", "count", "counts"):
            del index[name]
        index["environment"] = None

    change(path, older)
    assert len(files.load(path).cloud) == COUNT


def test_a_folder_is_replaced_whole_and_only_if_it_is_of_this_kind(tmp_path: Path) -> None:
    path = write(tmp_path / "a.lod")
    before = fingerprint(path)
    with pytest.raises(UserError, match="exists"):
        write(path)
    write(path, degree=0, chunk_rows=100, force=True)
    assert fingerprint(path) != before
    (path / "0_0" / "notes.txt").write_text("mine")
    with pytest.raises(UserError, match=r"also holds 0_0/notes.txt"):
        write(path, force=True)
    assert (path / "0_0" / "notes.txt").read_text() == "mine" and len(files.load(path).cloud) == COUNT
    assert [p.name for p in tmp_path.iterdir()] == ["a.lod"]


def test_a_failed_writing_leaves_nothing(tmp_path: Path) -> None:
    whole = cloud()
    broken = whole.replace(opacities=whole.opacities * float("nan"))
    path = write(tmp_path / "a.lod")
    before = fingerprint(path)
    for target, force in ((path, True), (tmp_path / "b.lod", False)):
        with pytest.raises(UserError, match="NaN"):
            streamed_sog_writing.save(Levels((whole, broken), tree(whole)), target, force)
    assert fingerprint(path) == before and [p.name for p in tmp_path.iterdir()] == ["a.lod"]


def test_a_field_is_bound_to_all_chunks(tmp_path: Path) -> None:
    """Colours change no count and no bound, so the index alone would be the same."""
    whole = cloud()
    for name, colours in (("a.lod", whole.sh), ("b.lod", whole.sh + 0.5)):
        streamed_sog_writing.save(Levels((whole.replace(sh=colours),), tree(whole)), tmp_path / name)
    a, b = tmp_path / "a.lod", tmp_path / "b.lod"
    assert (a / "lod-meta.json").read_bytes() == (b / "lod-meta.json").read_bytes()
    assert fingerprint(a) != fingerprint(b) and fingerprint(a) == fingerprint(a / "lod-meta.json")


def test_only_convert_writes_it(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"only `scenewright convert SCENE a.lod` makes"):
        files.save(Scene(cloud()), tmp_path / "a.lod")


def change(path: Path, edit: Callable[[Index], object]) -> None:
    index = json.loads((path / "lod-meta.json").read_text())
    edit(index)
    (path / "lod-meta.json").write_text(json.dumps(index))


def first_leaf(index: Index) -> Index:
    node = index["tree"]
    while "children" in node:
        node = node["children"][0]
    return node


def run(index: Index) -> Index:
    return first_leaf(index)["lods"]["0"]


LIES: dict[str, tuple[Callable[[Index], object], str]] = {
    "another version": (lambda i: i.update(version=2), "version"),
    "no tree": (lambda i: i.pop("tree"), "tree"),
    "no levels": (lambda i: i.update(lodLevels=0), "lodLevels"),
    "many levels": (lambda i: i.update(lodLevels=10**9), "lodLevels"),
    "one level fewer": (lambda i: i.update(lodLevels=2), "level 2"),
    "out of the folder": (lambda i: i["filenames"].__setitem__(0, "../b.lod/0_0/meta.json"), "outside its folder"),
    "an absolute path": (lambda i: i["filenames"].__setitem__(0, "/etc/passwd"), "filenames.0"),
    "another drive": (lambda i: i["filenames"].__setitem__(0, "C:\\0_0\\meta.json"), "filenames.0"),
    "the environment outside": (lambda i: i.update(environment="../../x/meta.json"), "outside its folder"),
    "itself as a chunk": (lambda i: i["filenames"].__setitem__(0, "lod-meta.json"), "not a valid zip archive"),
    "a chunk twice": (lambda i: i["filenames"].__setitem__(1, "0_0/meta.json"), "names a chunk twice"),
    "a chunk twice, spelled otherwise": (lambda i: i["filenames"].__setitem__(1, "./0_0/meta.json"), "twice"),
    "an unknown chunk": (lambda i: run(i).update(file=99), "chunk 99"),
    "a missing chunk": (lambda i: i["filenames"].__setitem__(0, "9_9/meta.json"), "9_9/meta.json is missing"),
    "more rows than there are": (lambda i: run(i).update(count=10**9), "do not divide 0_0/meta.json"),
    "negative rows": (lambda i: run(i).update(offset=-5), "offset"),
    "rows that overlap": (lambda i: run(i).update(offset=1), "do not divide 0_0/meta.json"),
    "two levels in a chunk": (lambda i: first_leaf(i)["lods"].update({"1": run(i)}), "do not divide"),
    "a level that is no number": (lambda i: first_leaf(i)["lods"].update({"x": run(i)}), "lods"),
    "false counts": (lambda i: i.update(counts=[900, 450, 201]), r"says \(900, 450, 201\) Gaussians a level"),
    "three children": (lambda i: i["tree"]["children"].append(i["tree"]["children"][0]), "children"),
    "infinite bounds": (lambda i: i["tree"]["bound"]["min"].__setitem__(0, float("nan")), "bound.min"),
    "nothing at all": (lambda i: (i.pop("counts"), i["tree"].pop("children")), "zero Gaussians"),
}  # fmt: skip


@pytest.mark.parametrize("lie", LIES)
def test_lies_are_refused(tmp_path: Path, lie: str) -> None:
    edit, message = LIES[lie]
    change(write(tmp_path / "a.lod"), edit)
    with pytest.raises(FileError, match=message):
        files.load(tmp_path / "a.lod")


def test_more_rows_than_bytes_are_refused_before_reading(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(tmp_path / "a.lod")
    monkeypatch.setattr(streamed_sog.sog, "read", lambda path: pytest.fail("was read"))

    def many(index: Index) -> None:
        index.pop("counts")
        index["filenames"] = ["0_0/meta.json"]
        index["tree"] = {"bound": index["tree"]["bound"], "lods": {"0": {"file": 0, "offset": 0, "count": 10**7}}}

    change(path, many)
    with pytest.raises(FileError, match=r"10,000,000 Gaussians do not fit into the bytes of 0_0/meta.json"):
        files.load(path)


def test_a_chunk_with_other_rows_than_its_leaves_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "a.lod")
    shutil.rmtree(path / "0_0")
    shutil.copytree(path / "2_0", path / "0_0")
    with pytest.raises(FileError, match=r"0_0/meta.json holds 200 Gaussians, the leaves of lod-meta.json say"):
        files.load(path)


def test_a_link_out_of_the_folder_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "a.lod")
    shutil.move(path / "0_0", tmp_path / "elsewhere")
    (path / "0_0").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(FileError, match="outside its folder"):
        files.load(path)


@pytest.mark.parametrize("text", ['{"tree":' * 20_000, '{"a":', "", "[]", "\xff"])
def test_an_index_that_is_cut_off_or_too_deep_is_refused(tmp_path: Path, text: str) -> None:
    path = write(tmp_path / "a.lod")
    (path / "lod-meta.json").write_bytes(text.encode("latin1"))
    with pytest.raises(FileError, match="not a Streamed SOG index"):
        files.load(path)


def test_a_deep_tree_is_read_or_refused_but_never_a_crash(tmp_path: Path) -> None:
    path = write(tmp_path / "a.lod")

    def deepen(index: Index) -> None:
        bound = index["tree"]["bound"]
        for _ in range(400):
            index["tree"] = {"bound": bound, "children": [{"bound": bound, "lods": {}}, index["tree"]]}

    index = json.loads((path / "lod-meta.json").read_text())
    deepen(index)
    (path / "lod-meta.json").write_text(json.dumps(index))
    with pytest.raises(FileError, match="not a Streamed SOG index"):
        files.load(path)


PROGRAM = shutil.which("splat-transform")


@pytest.mark.slow
@pytest.mark.skipif(
    PROGRAM is None,
    reason="splat-transform is not on the PATH (npm install @playcanvas/splat-transform; add node_modules/.bin)",
)
class TestOracle:
    """Against PlayCanvas' own program; reading needs its version 3."""

    def transform(self, *words: str | Path) -> None:
        assert PROGRAM is not None
        done = subprocess.run(
            [PROGRAM, "-q", "-w", "-g", "cpu", *map(str, words)], capture_output=True, text=True, timeout=120
        )
        assert done.returncode == 0, done.stderr

    def test_what_we_write_is_read_alike(self, tmp_path: Path) -> None:
        assert PROGRAM is not None
        version = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, timeout=60).stdout
        if "v2." in version:
            pytest.skip("this splat-transform writes Streamed SOG only; reading it came with version 3 (needs node 22)")
        path = write(tmp_path / "a.lod")
        for k in range(3):
            self.transform(path / "lod-meta.json", "--select-lod", str(k), tmp_path / f"{k}.ply")
            ours = Streamed.open(path).level(k)[0]
            theirs = matched(files.load(tmp_path / f"{k}.ply").cloud, ours)
            for (name, a), (_, b) in zip(ours.columns(), theirs.columns(), strict=True):
                if name not in ("ids", "group", "quats"):
                    assert torch.allclose(a, b, rtol=2e-5, atol=2e-6)  # logarithms and logits in float32 lie between
            assert (1 - (ours.quats * theirs.quats).sum(dim=1).abs()).max() < 2e-6

    def test_what_they_write_is_read_alike(self, tmp_path: Path) -> None:
        for name, count in (("0", 900), ("1", 450)):
            files.save(Scene(cloud()[:count]), tmp_path / f"{name}.ply")
        place = tmp_path / "out" / "lod-meta.json"
        place.parent.mkdir()
        self.transform(tmp_path / "0.ply", "-l", "0", tmp_path / "1.ply", "-l", "1", place)
        streamed = Streamed.open(place)
        assert streamed.counts == (900, 450)
        for k, count in enumerate((900, 450)):
            got = matched(streamed.level(k)[0], cloud()[:count])
            assert torch.allclose(got.means, cloud().means[:count], atol=2e-4)
            assert torch.allclose(got.opacities, cloud().opacities[:count], atol=1.01 / 255)
