"""A thing can get the colour of another thing: what it shows afterwards is what the other one shows."""

from __future__ import annotations

import pytest

from scenewright.gaussians.errors import AbsentError, UserError
from scenewright.gaussians.scene import Scene
from scenewright.tools.coloring.seen import lit_face, seen_colors
from scenewright.tools.execute import carry_out
from scenewright.tools.operation import Context
from scenewright.tools.registry import parse

CHAIR, RED_CHAIR = 1, 2  # groups of the corner


def test_the_chair_looks_like_the_armchair(corner: Scene, context: Context) -> None:
    op = parse({"op": "recolor", "target": {"text": "chair"}, "like": {"text": "armchair"}})
    done = carry_out(corner, op, context)
    rows = {g: (scene.cloud.group == g).nonzero()[:, 0] for g, scene in ((CHAIR, done.scene), (RED_CHAIR, corner))}
    shown = lit_face(seen_colors(done.scene, rows[CHAIR]))
    wanted = lit_face(seen_colors(corner, rows[RED_CHAIR]))
    was = lit_face(seen_colors(corner, (corner.cloud.group == CHAIR).nonzero()[:, 0]))
    # A quarter of the way is left at most: the same pigment is lit differently on faces of another shape.
    assert float((shown - wanted).norm()) < 0.25 * float((was - wanted).norm())
    assert (done.scene.cloud.sh == corner.cloud.sh)[rows[RED_CHAIR]].all()


def test_a_colour_of_what_is_not_there_is_refused(corner: Scene, context: Context) -> None:
    op = parse({"op": "recolor", "target": {"text": "chair"}, "like": {"text": "piano"}})
    with pytest.raises(AbsentError):
        carry_out(corner, op, context)


def test_a_colour_is_given_once() -> None:
    for more in ({"color": "red"}, {"adjust": "darker"}):
        with pytest.raises(UserError, match="like"):
            parse({"op": "recolor", "target": {"text": "chair"}, "like": {"text": "piano"}, **more})
