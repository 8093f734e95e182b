"""`budget` measures what dropping each part of a scene loses, and `Course` optimises what is left."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from three_balls import RING, SIZE, balls

from scenewright.gaussians.slim import Settings, slim
from scenewright.gaussians.slim.budget import budget, field_bits, shortened
from scenewright.gaussians.slim.loss import EXACT, Truth
from scenewright.gaussians.slim.optimise import LEG, Course
from scenewright.gaussians.slim.report import inria_bytes
from scenewright.gaussians.slim.views import choose_views


def test_every_part_is_measured() -> None:
    scene = balls(900, degree=2)
    found = budget(scene, RING, size=SIZE)
    rows = {part: [row for row in found.rows if row.part == part] for part in ("harmonics", "gaussians", "thing")}
    assert found.bytes == inria_bytes(scene.cloud) == len(scene.cloud) * 4 * (14 + 27)
    assert [row.what for row in rows["harmonics"]] == [
        f"bands above degree {degree}, their mean colour kept" for degree in (1, 0)
    ]
    truth = Truth(scene.cloud, choose_views(scene, RING, SIZE).choice)
    plain, made_up = truth.loss(scene.cloud.with_degree(0)).psnr, rows["harmonics"][1].psnr
    assert made_up is not None and plain < made_up < 60
    losses = [row.psnr for row in rows["gaussians"]]
    assert None not in losses and losses == sorted(losses, key=lambda psnr: -(psnr or 0))
    assert len(rows["thing"]) == 3 and all(row.psnr is not None and row.psnr < 30 for row in rows["thing"])
    assert sum(row.share for row in rows["thing"]) == pytest.approx(float((scene.cloud.group >= 0).float().mean()))


def test_the_bits_of_a_field_are_counted() -> None:
    scene = balls(1000)
    bits = field_bits(scene)
    assert bits["groups"] == 32
    assert bits["vectors"] == 3 * 4 * 32 / 1000
    assert field_bits(scene.replace(language=None)) == {}
    assert budget(scene, RING, size=32).vector_bits == 4 * 32


def test_all_dimensions_keep_the_vectors() -> None:
    rng = np.random.default_rng(2)
    vectors = rng.normal(size=(20, 8)).astype(np.float32)
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    vectors[3] = 0
    assert np.abs(shortened(vectors, 8) - vectors).max() < 1e-6
    flat = shortened(vectors, 3)
    assert np.linalg.matrix_rank(flat, tol=1e-4) == 3
    assert np.abs(np.linalg.norm(flat, axis=1) - (np.arange(20) != 3)).max() < 1e-6


def test_a_leg_brings_the_pictures_nearer_to_the_original() -> None:
    scene = balls(900)
    views = choose_views(scene, RING, SIZE)
    fewer = scene.cloud[torch.arange(0, len(scene.cloud), 2)]
    course = Course(views.training, scene.cloud, LEG, None, lambda stage, share: None)
    better = course.optimised(fewer)
    truth = Truth(scene.cloud, views.held_out)
    assert truth.loss(better).psnr > truth.loss(fewer).psnr + 1
    assert course.over and course.steps == LEG
    assert (better.ids == fewer.ids).all() and (better.group == fewer.group).all()
    assert (better.sh.shape == fewer.sh.shape) and truth.loss(scene.cloud).psnr == EXACT


@pytest.mark.slow
def test_optimising_for_steps_gives_smaller_files_and_equal_bytes() -> None:
    plain = slim(balls(900), ".sog", Settings(30.0, SIZE), RING)
    first, second = (slim(balls(900), ".sog", Settings(30.0, SIZE, steps=2 * LEG), RING) for _ in range(2))
    assert first.data == second.data
    assert len(first.data) <= len(plain.data)
    assert len(first.scene.cloud) < len(plain.scene.cloud)
    assert first.held_out is not None and first.held_out.psnr >= 30
    assert first.steps == 2 * LEG
