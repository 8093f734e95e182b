"""Renders of groups, alone and on their background; no image is encoded twice."""

from __future__ import annotations

import hashlib
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import BackendError
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.encoders import cache
from scenewright.gaussians.language.encoders.calibration import Calibration
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.language.field.embed import embed
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.resolve import resolve
from scenewright.gaussians.language.segmentation.group_renders import cameras_around, mean_vectors, render_group
from scenewright.gaussians.render import render
from scenewright.gaussians.scene import Frame, Scene

if TYPE_CHECKING:
    from painted_world import World

Pictures = NDArray[np.uint8]
_FRAME = Frame((0.0, 0.0, 1.0), 0.0)
_EYE_SIDE = np.array([0.0, -4.0, 0.5])  # middle of the scene: groups are rendered from this side


class Counting:
    """Vectors from the pixels by hash, so that any mix-up shows; their last bits depend on the size of the batch, as
    those of real encoders do. Counts the pictures it was shown that are not blank."""

    dim, image_size = 6, 24
    vocabulary = Vocabulary({"box": ()}, {}, ("part",))
    calibration = Calibration(8.0, 0.5)

    def __init__(self, fingerprint: str, on_background: bool = False) -> None:
        self.fingerprint = fingerprint
        self.on_background = on_background
        self.shown: list[Pictures] = []

    def encode_images(self, images: Pictures) -> NDArray[np.float32]:
        self.shown += [i for i in images if i.any()]
        rows = np.stack([self._row(i) for i in images]) if len(images) else np.zeros((0, self.dim), np.float32)
        return rows + np.float32(1e-6 * len(images))

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        return np.eye(self.dim, dtype=np.float32)[: len(texts)]

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return ()

    def knows(self, text: str) -> bool:
        return True

    def _row(self, image: Pictures) -> NDArray[np.float32]:
        digest = hashlib.sha256(self.fingerprint.encode() + image.tobytes()).digest()
        row = np.frombuffer(digest[: self.dim], np.uint8).astype(np.float32) - 127.5
        unit: NDArray[np.float32] = row / np.linalg.norm(row)
        return unit


def _pictures(count: int, seed: int = 0) -> Pictures:
    return np.random.default_rng(seed).integers(1, 255, (count, 4, 4, 3)).astype(np.uint8)


@given(st.lists(st.lists(st.integers(0, 40), max_size=30), max_size=5))
def test_remembered_vectors_are_those_that_would_be_computed_again(calls: list[list[int]]) -> None:
    """Whatever was encoded before, in whatever company: the bytes of a picture's vector depend on its pixels alone."""
    pictures, memory, encoder = _pictures(41), cache.VectorCache(), Counting("one")
    for rows in calls:
        got = cache.images(encoder, pictures[rows], memory)
        fresh = [cache.images(Counting("one"), pictures[[row]], cache.VectorCache()) for row in rows]
        assert got.tobytes() == b"".join(v.tobytes() for v in fresh)
    assert len(encoder.shown) == len({row for rows in calls for row in rows})  # each once


def test_encoders_never_share_and_equal_ones_do() -> None:
    pictures, memory = _pictures(5), cache.VectorCache()
    one, other, again = Counting("one"), Counting("other"), Counting("one")
    first = cache.images(one, pictures, memory)
    assert not np.allclose(cache.images(other, pictures, memory), first)
    assert cache.images(again, pictures, memory).tobytes() == first.tobytes()
    assert (len(one.shown), len(other.shown), len(again.shown)) == (5, 5, 0)


def test_pictures_of_other_shapes_are_other_pictures() -> None:
    memory, encoder = cache.VectorCache(), Counting("one")
    tall, wide = np.full((1, 8, 2, 3), 9, np.uint8), np.full((1, 2, 8, 3), 9, np.uint8)
    cache.images(encoder, tall, memory)
    cache.images(encoder, wide, memory)
    assert len(encoder.shown) == 2


def test_memory_is_bounded_and_forgets_the_longest_unused() -> None:
    row = np.zeros(6, np.float32)
    memory = cache.VectorCache(max_bytes=3 * row.nbytes)
    for i in range(3):
        memory.put(("e", bytes([i])), row + i)
    assert memory.get(("e", b"\0")) is not None  # now the second is the longest unused
    memory.put(("e", b"\3"), row)
    assert memory.get(("e", b"\1")) is None and memory.get(("e", b"\0")) is not None
    kept = memory.get(("e", b"\2"))
    assert kept is not None
    with pytest.raises(ValueError, match="read-only"):
        kept[0] = 1
    # One too small for a single row forgets at once, and the answers are still right.
    pictures = _pictures(20)
    tiny = cache.images(Counting("one"), pictures, cache.VectorCache(max_bytes=1))
    assert tiny.tobytes() == cache.images(Counting("one"), pictures, cache.VectorCache()).tobytes()


def test_threads_get_the_same_bytes() -> None:
    pictures, memory = _pictures(60), cache.VectorCache()
    expected = cache.images(Counting("one"), pictures, cache.VectorCache()).tobytes()
    with ThreadPoolExecutor(4) as pool:
        jobs = [pool.submit(cache.images, Counting("one"), pictures, memory) for _ in range(8)]
    assert all(job.result().tobytes() == expected for job in jobs)


def test_nothing_to_encode() -> None:
    encoder = Counting("one")
    assert cache.images(encoder, _pictures(0)).shape == (0, encoder.dim)
    assert not encoder.shown


def _room(world: type[World]) -> GaussianCloud:
    """A red box before a green wall, and a blue board that hides the box from the middle of the scene."""
    build = world(seed=4)
    build.box("box", (-0.4, -0.4, 0.0), (0.4, 0.4, 0.8), (0.9, 0.1, 0.1))
    build.sheet("wall", (-3.0, 1.0, -1.0), (6.0, 0, 0), (0, 0, 4.0), (0.1, 0.8, 0.1), step=0.08)
    build.sheet("board", (-2.0, -0.8, -1.0), (4.0, 0, 0), (0, 0, 3.0), (0.1, 0.1, 0.9), step=0.08)
    return build.cloud()


def _shares(picture: Pictures) -> NDArray[np.float64]:
    """Share of the pixels in which red, green and blue stand out."""
    rgb = picture.astype(int)
    rest = np.stack([rgb[..., [1, 2]].max(-1), rgb[..., [0, 2]].max(-1), rgb[..., [0, 1]].max(-1)], -1)
    shares: NDArray[np.float64] = (rgb > rest + 60).mean(axis=(0, 1))
    return shares


def test_a_thing_is_shown_alone_and_on_its_background_but_never_behind_what_hides_it(world: type[World]) -> None:
    room = _room(world)
    box = room[: int((room.means[:, 1].abs() <= 0.5).sum())]
    assert float(box.means[:, 1].max()) < 0.5  # the box is the first sheets
    alone = render_group(box, _FRAME, _EYE_SIDE, 48, 3)
    both = render_group(box, _FRAME, _EYE_SIDE, 48, 3, room)
    assert len(alone) == 3 and len(both) == 6
    for own, first, second in zip(alone, both[0::2], both[1::2], strict=True):
        np.testing.assert_array_equal(own, first)  # the scene around does not change the picture alone
        red, green, _ = _shares(second)
        assert _shares(own)[1] == 0 and green > 0.1  # the wall
        # Nothing of the box is hidden; its rim, one pixel of about 25 across, blends with the wall.
        assert red > 0.9 * _shares(own)[0] > 0.4
    assert _shares(both[3])[2] == 0  # straight on, all of the board is in front
    straight = cameras_around(box.means.double().numpy(), _FRAME, _EYE_SIDE, 48, 2)[1]
    assert _shares((render(room, straight).rgb.numpy() * 255).astype(np.uint8))[2] > 0.9  # and would hide the box


def test_only_encoders_of_photographs_are_shown_the_background(world: type[World]) -> None:
    room = _room(world)
    box = room[:100]
    plain, photographic = Counting("plain"), Counting("photographic", on_background=True)
    mean_vectors(plain, [box], _FRAME, _EYE_SIDE, 2, around=room)
    vectors = mean_vectors(photographic, [box, box[:0]], _FRAME, _EYE_SIDE, 2, around=room)
    assert len(plain.shown) == 2 and len(photographic.shown) == 4
    expected = np.sum([photographic._row(p) for p in photographic.shown], axis=0)
    np.testing.assert_allclose(vectors[0], expected / np.linalg.norm(expected), atol=1e-4)  # what the batch adds
    assert not vectors[1].any()  # nothing to be seen


def _two_boxes(world: type[World]) -> Scene:
    build = world(seed=2)
    build.sheet("floor", (-2, -2, 0), (4, 0, 0), (0, 4, 0), (0.6, 0.5, 0.4), step=0.06)
    build.box("a", (-0.9, -0.3, 0.0), (-0.3, 0.3, 0.6), (0.9, 0.2, 0.1))
    build.box("b", (0.4, -0.3, 0.0), (1.0, 0.3, 0.5), (0.1, 0.3, 0.9))
    return Scene(build.cloud())


@pytest.mark.parametrize("fixture", ["saved_clip", "exported_clip"])
@pytest.mark.slow
def test_a_scene_is_embedded_and_asked_with_real_towers(
    world: type[World], fixture: str, request: pytest.FixtureRequest
) -> None:
    back_end = {"saved_clip": "open_clip", "exported_clip": "onnx"}[fixture]
    encoder = encoders.load(f"{back_end}:{request.getfixturevalue(fixture)}")
    scene = embed(_two_boxes(world), encoder)
    field = scene.language
    assert field is not None
    field.require_encoder(encoder.fingerprint)
    objects = [g.id for g in field.objects()]
    assert objects and field.embeddings.shape[1] == encoder.dim
    np.testing.assert_allclose(np.linalg.norm(field.embeddings[objects], axis=1), 1, atol=1e-5)
    camera = cameras_around(scene.cloud.means.double().numpy(), scene.frame, np.zeros(3), 64, 1)[0]
    answer = resolve(scene, Query(text="chair"), camera, encoder)
    # The towers are random, so what they find means nothing; that a term was scored for each object does.
    assert answer.verdict in ("found", "ambiguous", "absent")
    assert answer.candidates and all(0 <= c.terms["text"] <= 1 for c in answer.candidates)
    with pytest.raises(BackendError, match="encoder"):
        resolve(scene, Query(text="chair"), camera, encoders.load())


@pytest.mark.slow
def test_embedding_again_encodes_nothing_again(world: type[World]) -> None:
    scene = _two_boxes(world)
    first, again = Counting("embedding"), Counting("embedding")
    before, after = embed(scene, first), embed(scene, again)
    assert before.language is not None and after.language is not None
    assert first.shown and not again.shown
    assert before.language.embeddings.tobytes() == after.language.embeddings.tobytes()
    assert torch.equal(before.cloud.group, after.cloud.group)


def test_the_shipped_encoder_gives_the_same_bytes_from_the_cache() -> None:
    encoder = encoders.load()
    pictures = (
        np.random.default_rng(3).integers(0, 255, (37, encoder.image_size, encoder.image_size, 3)).astype(np.uint8)
    )
    memory = cache.VectorCache()
    some = cache.images(encoder, pictures[5:9], memory)
    every = cache.images(encoder, pictures, memory)
    assert some.tobytes() == every[5:9].tobytes()
    assert every.tobytes() == cache.images(encoder, pictures, cache.VectorCache()).tobytes()
    np.testing.assert_allclose(every, encoder.encode_images(pictures), atol=1e-5)  # another size of batch
