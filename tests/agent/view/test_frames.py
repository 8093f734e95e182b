"""A moment for the page: the rows of all that changes with time, as the scene has them then, and back to the start."""

from __future__ import annotations

import numpy as np
import pytest

from scenewright.agent.view import wire
from scenewright.agent.view.changes import Shown
from scenewright.agent.view.columns import columns_of, decode, encode, width
from scenewright.agent.view.frames import frame
from scenewright.agent.view.slots import slots_of
from scenewright.agent.view.state import box_json, span
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.motion.at import at
from scenewright.gaussians.motion.motion import without_ids
from tests.support.moving_balls import moving


def held(shown: Shown) -> dict[str, bytearray]:
    """What a page holds of a scene at its start, by column."""
    whole = {c: encode(shown.scene.cloud, shown.owner, c, shown.slots.rows) for c in columns_of(shown.degree)}
    return {column: bytearray(data) for column, data in whole.items()}


def take(page: dict[str, bytearray], message: bytes, degree: int) -> None:
    _, parts = wire.read(message)
    for column, part in parts.items():
        size = width(column, degree)
        for i, slot in enumerate(slots_of(part.ranges).tolist()):
            page[column][slot * size : (slot + 1) * size] = part.data[i * size : (i + 1) * size]


@pytest.mark.parametrize("degree", [0, 1])
def test_a_page_shows_the_scene_at_a_time_and_the_start_again(degree: int) -> None:
    scene = moving(degree)
    shown = Shown.first(scene, 5)
    page, first = held(shown), held(shown)
    for time in (1.0, 2.7):
        message = frame(shown, time, 8)
        header, _ = wire.read(message)
        assert (header["type"], header["base"], header["revision"]) == ("frame", 5, 5)
        assert (header["time"], header["id"]) == (time, 8)
        take(page, message, degree)
        there, table = at(scene, time).cloud, at(scene, time).language
        assert table is not None
        assert header["boxes"] == {str(g): box_json(table.groups[g].box) for g in (0, 1)}
        slots = shown.slots.slot[np.searchsorted(scene.cloud.ids.numpy(), there.ids.numpy())]
        assert np.array_equal(decode(bytes(page["position"]), "position")["means"][slots], there.means.numpy())
        for column in columns_of(degree):
            got = {k: v.reshape(shown.slots.count, -1)[slots] for k, v in decode(bytes(page[column]), column).items()}
            want = decode(encode(there, shown.owner, column, np.arange(len(there))), column)
            for name, values in want.items():
                np.testing.assert_array_equal(got[name], values.reshape(len(there), -1))
        left_out = np.setdiff1d(np.arange(shown.slots.count), slots)
        assert (len(left_out) > 0) == (time == 2.7)
        assert not decode(bytes(page["color"]), "color")["opacities"][left_out].any()
    take(page, frame(shown, 0.0, 9), degree)
    assert page == first


def test_a_motion_is_told_from_another_and_a_static_scene_has_none() -> None:
    scene = moving()
    first = span(scene.motion)
    assert first is not None and (first["start"], first["stop"]) == (0.0, 4.0)
    assert span(moving().motion) == first
    fewer = without_ids(scene.motion, scene.cloud.ids[:40].numpy())
    other = span(fewer)
    assert other is not None and other["version"] != first["version"]
    assert span(None) is None
    with pytest.raises(UserError, match="nothing moves"):
        frame(Shown.first(scene.replace(motion=None)), 1.0, 1)
