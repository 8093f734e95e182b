"""bench slim: what it measures of one small scene, and that a name found elsewhere is told."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch
from three_balls import RING, SIZE, balls

from scenewright.benchmarks import slim as bench
from scenewright.gaussians.language import encoders
from scenewright.gaussians.language.field.embed import embed
from scenewright.gaussians.scene import Scene
from scenewright.gaussians.slim import prepare


@pytest.fixture(scope="module")
def case() -> bench.Case:
    scene, encoder = balls(900), encoders.load()
    whole = embed(scene.replace(language=None), encoder)
    return bench.Case("balls", whole, prepare(whole, RING, SIZE), encoder)


@pytest.mark.slow
def test_every_setting_is_measured_and_the_stronger_promise_takes_more_bytes(
    case: bench.Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bench, "_cases", lambda quick: ([case], []))
    wanted = [bench.Setting(".sog", psnr) for psnr in (26.0, 34.0)] + [bench.Setting(".splat", 90.0)]
    monkeypatch.setattr(bench, "_settings", lambda quick: wanted)
    result = bench.run(True)
    figures = {metric.key: metric.value for metric in result.metrics}
    assert figures["balls.sog 26.bytes"] < figures["balls.sog 34.bytes"]
    assert figures["balls.sog 34.psnr"] >= 34
    assert figures["balls.field.groups"] == 32
    assert len(result.points) == 2
    assert any("splat at 90 dB: the format alone loses more on balls" in note for note in result.notes)


def test_a_name_counts_only_if_its_selection_is_the_image(case: bench.Case) -> None:
    scene = named(case.scene)
    half = scene.replace(cloud=scene.cloud[torch.arange(0, len(scene.cloud), 2)])
    assert bench.names_found(scene, half, case.encoder) == 1.0
    group = half.cloud.group.clone()
    group[::3] = -1
    assert bench.names_found(scene, half.replace(cloud=half.cloud.replace(group=group)), case.encoder) < 1.0


def named(scene: Scene) -> Scene:
    """The scene with its first thing surely called a ball."""
    assert scene.language is not None
    first = next(g for g in scene.language.groups if g.level == "object" and g.count)
    groups = tuple(
        replace(g, label="ball", label_score=0.99, names=(("ball", 0.99),), named_by="user") if g is first else g
        for g in scene.language.groups
    )
    return scene.replace(language=replace(scene.language, groups=groups))
