"""The backward pass of the CPU renderer: against autograd of the reference renderer in float64, against finite
differences, and its invariants."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Tensor

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.render import cpu, differentiable, reference, render

NAMES = ("means", "quats", "scales", "opacities", "sh")
BACKGROUND = (0.2, 0.4, 0.6)


def columns(count: int, degree: int, seed: int, opaque: float = 0.8, size: float = 0.15) -> dict[str, Tensor]:
    g = torch.Generator().manual_seed(seed)
    return {
        "means": torch.randn(count, 3, generator=g) * 0.7,
        "quats": torch.randn(count, 4, generator=g),  # of any length: the length must have no gradient
        "scales": torch.rand(count, 3, generator=g) * size + 0.02,
        "opacities": torch.rand(count, generator=g) * opaque + 0.1,
        "sh": torch.randn(count, (degree + 1) ** 2, 3, generator=g) * 0.4,
    }


def view(width: int = 75, height: int = 53, side: float = 0.3) -> Camera:
    """Sizes that are no multiple of a tile, so that tiles are cut by the border."""
    return Camera.look_at([side, -4, 1], [0, 0, 0], [0, 0, 1], width, height)


def weights(camera: Camera, seed: int = 5) -> tuple[Tensor, Tensor]:
    """A random linear loss over colour and alpha."""
    g = torch.Generator().manual_seed(seed)
    return torch.randn(camera.height, camera.width, 3, generator=g), torch.randn(
        camera.height, camera.width, generator=g
    )


def fast(made: dict[str, Tensor], camera: Camera, background: Any = BACKGROUND) -> dict[str, Tensor]:
    """Gradients of the random loss by the columns and by the footprints' centres."""
    leaves = {k: c.clone().requires_grad_() for k, c in made.items()}
    centers = torch.zeros(len(made["means"]), 2, requires_grad=True)
    rgb, alpha = differentiable.draw(*leaves.values(), camera, background, centers)
    on_rgb, on_alpha = weights(camera)
    ((rgb * on_rgb).sum() + (alpha * on_alpha).sum()).backward()  # type: ignore[no-untyped-call]
    return {k: c.grad for k, c in {**leaves, "centers": centers}.items() if c.grad is not None}


def as_cloud(made: dict[str, Tensor]) -> GaussianCloud:
    count = len(made["means"])
    return GaussianCloud(**made, group=torch.zeros(count, dtype=torch.int32), ids=torch.arange(count))


def slow(made: dict[str, Tensor], camera: Camera) -> dict[str, Tensor]:
    leaves = {k: c.clone().requires_grad_() for k, c in made.items()}
    picture = reference.render(as_cloud(leaves), camera, BACKGROUND, torch.float64)
    on_rgb, on_alpha = weights(camera)
    ((picture.rgb * on_rgb).sum() + (picture.alpha * on_alpha).sum()).backward()  # type: ignore[no-untyped-call]
    return {k: c.grad for k, c in leaves.items() if c.grad is not None}


def apart(a: Tensor, b: Tensor) -> float:
    return float((a - b).norm() / b.norm())


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
@pytest.mark.parametrize(("count", "opaque", "size"), [(60, 0.8, 0.15), (400, 0.4, 0.3), (60, 0.89, 0.02)])
def test_gradients_equal_those_of_the_reference_renderer(degree: int, count: int, opaque: float, size: float) -> None:
    made, camera = columns(count, degree, seed=degree, opaque=opaque, size=size), view()
    found, wanted = fast(made, camera), slow(made, camera)
    for name in NAMES:
        assert apart(found[name], wanted[name]) < 1e-4, name  # the bound; float32 gives about 2e-6


def test_gradients_are_right_for_a_close_camera_with_much_outside_the_image() -> None:
    made = columns(200, 3, seed=8)
    camera = Camera.look_at([0.4, -1.1, 0.2], [0, 0, 0], [0, 0, 1], 61, 47, 75.0)
    found, wanted = fast(made, camera), slow(made, camera)
    for name in NAMES:
        assert apart(found[name], wanted[name]) < 1e-4, name


def test_gradients_equal_finite_differences_of_the_reference_renderer() -> None:
    """Central differences over float64 pictures, along random directions: shares no derivative with anything."""
    made, camera = columns(25, 2, seed=3), view(40, 30)
    on_rgb, on_alpha = weights(camera)
    g = torch.Generator().manual_seed(0)
    found = fast(made, camera)
    for name in NAMES:
        way = torch.randn(made[name].shape, generator=g)
        step = 1e-3 * float(made[name].abs().mean())
        ends = []
        for sign in (1, -1):
            picture = reference.render(
                as_cloud({**made, name: made[name] + sign * step * way}), camera, BACKGROUND, torch.float64
            )
            ends.append(float((picture.rgb * on_rgb).sum() + (picture.alpha * on_alpha).sum()))
        slope = (ends[0] - ends[1]) / (2 * step)
        told = float((found[name] * way).sum())
        # the loss bends and footprints end at alpha 1/255 within the step: a few parts in a thousand of its scale
        assert abs(slope - told) < 0.01 * float(found[name].norm() * way.norm()), name


def test_the_differentiable_image_equals_the_renderers() -> None:
    made, camera = columns(300, 3, seed=1), view()
    made["quats"] = torch.nn.functional.normalize(made["quats"], dim=1)
    rgb, alpha = differentiable.draw(*made.values(), camera, BACKGROUND)
    picture = render(as_cloud(made), camera, BACKGROUND)
    assert torch.equal(rgb, picture.rgb) and torch.equal(alpha, picture.alpha)


@given(st.integers(0, 2**31), st.integers(1, 80), st.integers(1, 60), st.integers(1, 40))
def test_gradients_are_finite_and_a_quaternions_length_has_none(seed: int, width: int, height: int, count: int) -> None:
    made = columns(count, 3, seed=seed % 97)
    found = fast(made, view(width, height))
    assert all(g.isfinite().all() for g in found.values())
    along = (made["quats"] * found["quats"]).sum(dim=1)
    scale = found["quats"].norm(dim=1) * made["quats"].norm(dim=1)
    assert (along.abs() <= 1e-4 * scale + 1e-5).all()  # four products of float32 that cancel


def test_the_gradient_of_centres_equals_that_of_the_reference_renderer(monkeypatch: pytest.MonkeyPatch) -> None:
    made, camera = columns(200, 1, seed=9), view()
    centers = torch.zeros(200, 2, dtype=torch.float64, requires_grad=True)
    project = reference.project

    def moved(*arguments: Any) -> reference.Splats:
        splats = project(*arguments)
        return replace(splats, center=splats.center + centers[splats.row])

    monkeypatch.setattr(reference, "project", moved)
    slow(made, camera)
    assert centers.grad is not None and apart(fast(made, camera)["centers"], centers.grad) < 1e-4


def test_the_same_input_gives_the_same_bytes_on_any_number_of_threads() -> None:
    made, camera = columns(2000, 2, seed=4), view(160, 120)
    before, seen = torch.get_num_threads(), set()
    held: list[Any] = []
    rng = np.random.default_rng(0)
    try:
        for threads in (1, 2, 3, 2, 1):
            torch.set_num_threads(threads)
            held.append(np.empty(rng.integers(1, 200_000), np.uint8))
            seen.add(b"".join(g.numpy().tobytes() for g in fast(made, camera).values()))
    finally:
        torch.set_num_threads(before)
    assert len(seen) == 1


def test_pictures_drawn_before_the_backward_pass_change_no_gradient() -> None:
    made, camera = columns(300, 2, 8), view()
    leaves = {k: c.clone().requires_grad_() for k, c in made.items()}
    rgb, alpha = differentiable.draw(*leaves.values(), camera, BACKGROUND, torch.zeros(300, 2, requires_grad=True))
    for seed in (9, 10):  # as many Gaussians as fit into the same memory
        render(as_cloud(columns(300, 2, seed)), camera)
    on_rgb, on_alpha = weights(camera)
    ((rgb * on_rgb).sum() + (alpha * on_alpha).sum()).backward()  # type: ignore[no-untyped-call]
    alone = fast(made, camera)
    assert all(torch.equal(alone[k], leaf.grad) for k, leaf in leaves.items() if leaf.grad is not None)
    assert leaves["means"].grad is not None


def test_a_picture_drawn_in_strips_has_the_same_gradient(monkeypatch: pytest.MonkeyPatch) -> None:
    made, camera = columns(500, 1, seed=6), view(96, 128)
    whole = fast(made, camera)
    monkeypatch.setattr(cpu, "MAX_ENTRIES", 200)
    parts = fast(made, camera)
    for name in (*NAMES, "centers"):
        assert apart(parts[name], whole[name]) < 1e-5, name  # added up in another order


def test_invisible_gaussians_have_no_gradient() -> None:
    made, camera = columns(50, 2, seed=7), view()
    made["means"][:10, 1] = -9.0  # behind the eye
    made["means"][10, 0] = math.nan
    made["opacities"][11] = 0.001
    found = fast(made, camera)
    for name in (*NAMES, "centers"):
        assert not found[name][:12].any() and found[name][12:].any(), name


def test_an_opaque_gaussian_blocks_the_gradient_of_gaussians_behind_it() -> None:
    made, camera = columns(2, 0, seed=2), Camera.look_at([0, -3, 0], [0, 0, 0], [0, 0, 1], 16, 16)
    made["means"] = torch.tensor([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]])
    made["scales"] = torch.tensor([[300.0, 300.0, 300.0], [0.2, 0.2, 0.2]])
    made["opacities"] = torch.tensor([0.9995, 0.5])
    found = fast(made, camera)
    # alpha is at its maximum of 0.999 all over the picture: a thousandth of the light comes from behind
    assert found["sh"][1].abs().max() < 0.01 * found["sh"][0].abs().max()
    assert not found["opacities"][0]


def test_gradients_of_an_empty_cloud_are_empty() -> None:
    made = columns(0, 0, seed=0)
    found = fast(made, view())
    assert all(len(g) == 0 for g in found.values())


def test_other_types_than_float32_are_refused() -> None:
    made = {k: c.double() for k, c in columns(3, 0, seed=0).items()}
    with pytest.raises(UserError, match="float32 columns on the CPU"):
        differentiable.draw(*made.values(), view())
