"""Pictures on disk and what is drawn into them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from scenewright.agent.pictures.change_pictures import change_of
from scenewright.agent.pictures.image_files import Tile, beside, contact_sheet, save_png
from scenewright.agent.pictures.scene_pictures import camera_showing, numbered, picture, spotlight
from scenewright.agent.session.session import Session
from scenewright.gaussians.camera import Camera
from scenewright.gaussians.errors import UserError
from scenewright.gaussians.language.query.query import Query
from scenewright.gaussians.language.query.selection import Candidate, Selection
from scenewright.gaussians.scene import Scene


def test_a_png_comes_back_bit_for_bit_and_is_not_overwritten(tmp_path: Path) -> None:
    image = np.random.default_rng(0).integers(0, 256, (9, 7, 3), dtype=np.uint8)
    save_png(image, tmp_path / "a.png")
    assert np.array_equal(np.asarray(Image.open(tmp_path / "a.png")), image)
    with pytest.raises(UserError, match="exists"):
        save_png(image, tmp_path / "a.png")
    save_png(image, tmp_path / "a.png", force=True)


def test_a_contact_sheet_holds_every_tile() -> None:
    image = np.full((60, 90, 3), 120, dtype=np.uint8)
    tiles = [Tile(f"instruction {i} " * 12, "done", (image, image)) for i in range(3)] + [
        Tile("x", "no", (image,), False)
    ]
    sheet = contact_sheet("heading", tiles, columns=2, tile_width=400)
    assert sheet.shape[1] == 2 * 400 + 3 * 14
    grey = (sheet == 120).all(axis=2).mean()
    assert grey > 0.3  # the pictures are there and large


def test_side_by_side() -> None:
    image = np.zeros((4, 5, 3), dtype=np.uint8)
    assert beside([image, image], gap=3).shape == (4, 13, 3)


def test_the_spotlight_dims_all_but_the_selection(boxes: Scene) -> None:
    camera = boxes.cameras[0].resized(480, 320)
    ids = (boxes.cloud.group == 1).nonzero().squeeze(1)
    plain = picture(boxes, camera)
    lit = spotlight(boxes, camera, Selection(Query(text="x"), "found", ids, (1,)))
    same = (plain == lit).all(axis=2)
    green = (plain[..., 1].astype(int) - plain[..., 0]) > 90
    assert same[green].mean() > 0.8 and same[~green].mean() < 0.3
    assert torch.equal(boxes.cloud.group.unique(), torch.tensor([0, 1, 2, 3], dtype=torch.int32))


def test_what_is_asked_about_is_shown_from_where_it_is_seen(boxes: Scene) -> None:
    """The viewer's own camera if it shows it, else another that does."""
    camera = boxes.cameras[0].resized(480, 320)
    asked = Selection(Query(text="x"), "unconfirmed", (boxes.cloud.group == 1).nonzero().squeeze(1), (1,))
    assert camera_showing(boxes, asked, camera) is camera
    eye = camera.position
    away = Camera.look_at(
        list(eye), list(2 * eye - boxes.cloud.means.double().mean(dim=0).numpy()), [0, 0, 1], 480, 320
    )
    assert not (spotlight(boxes, away, asked) != spotlight(boxes, away, replace(asked, ids=asked.ids[:0]))).any()
    found = camera_showing(boxes, asked, away)
    assert (spotlight(boxes, found, asked) != spotlight(boxes, found, replace(asked, ids=asked.ids[:0]))).any()


def test_candidates_are_numbered_where_they_are_seen(boxes: Scene) -> None:
    camera = boxes.cameras[0].resized(480, 320)
    candidates = [Candidate(g, "box", "red", (0.0, -50.0, 0.4), (0.8, 0.8, 0.8), 1.0) for g in (0, 1)]
    plain = picture(boxes, camera)
    changed = (numbered(boxes, camera, candidates) != plain).any(axis=2)
    rows, columns = changed.nonzero()
    # The discs lie on the left and the middle box, whatever the stored centres say; nothing is drawn on the right one.
    for center in ((-2.0, 0.0, 0.4), (0.0, 0.3, 0.3)):
        (x, y), _ = (v[0] for v in camera.project(np.array([center])))
        assert (np.hypot(rows - y, columns - x) < 25).sum() > 100
    assert columns.max() < 320


def test_candidates_without_a_group_are_numbered_at_their_centre(boxes: Scene) -> None:
    camera = boxes.cameras[0].resized(480, 320)
    one = Candidate(-1, "patch", "red", (-2.0, 0.0, 0.4), (0.8, 0.8, 0.8), 1.0)
    behind = Candidate(-1, "patch", "red", (0.0, -50.0, 0.4), (0.8, 0.8, 0.8), 1.0)
    changed = (numbered(boxes, camera, [one, behind]) != picture(boxes, camera)).any(axis=2)
    (x, y), _ = (v[0] for v in camera.project(np.array([one.center])))
    rows, columns = changed.nonzero()
    # The mark is a disc of radius 9 around the projected centre; one pixel for the rim.
    assert len(rows) and np.abs(rows - y).max() <= 10.5 and np.abs(columns - x).max() <= 10.5


def test_a_change_is_counted_and_marked_where_it_is_seen(boxes: Scene, encoder: object) -> None:
    """Dimmed where nothing changed; nothing differs in a view that does not show it."""
    session = Session(boxes, planner="grammar", encoder=encoder, viewer=boxes.cameras[0], vlm=None)  # type: ignore[arg-type]
    result = session.preview("make the green thing blue")
    camera = boxes.cameras[0].resized(240, 160)
    change = change_of(result, camera)
    assert session.scene is boxes and change.gaussians == result.receipts[0].changed and change.of == len(boxes.cloud)
    drawn = picture(boxes, camera).astype(int)
    green = (drawn[..., 1] - drawn[..., 0]) > 90
    differs = (drawn != picture(result.scene, camera)).any(axis=2)
    assert green.mean() <= change.share <= differs.mean() and change.difference > 10
    assert change.picture.shape == (160, 3 * 240 + 2 * 6, 3)
    blue = picture(result.scene, camera)
    assert (change.marked[green] == blue[green]).all(axis=1).mean() > 0.7
    away = Camera.look_at((0, 0, 5), (0, 0, 9), (0, 1, 0), 60, 40)
    unseen = change_of(result, away)
    assert unseen.share == 0 and "nothing of the picture" in unseen.sentence()
