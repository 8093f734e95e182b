"""Three rooms of boxes side by side as a file with a language field, for scenes in tiles; and haze without a group."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import torch
from boxed_room import Thing, room, shell

from scenewright.gaussians.camera import Camera
from scenewright.gaussians.cloud import NO_GROUP, GaussianCloud, concat
from scenewright.gaussians.files import save
from scenewright.gaussians.language.field.language_field import LanguageField
from scenewright.gaussians.language.field.store import save_field
from scenewright.gaussians.scene import Scene

THINGS = (
    Thing("armchair", (-1.5, -1.5, 0.0), (-0.7, -0.7, 0.8), (0.7, 0.1, 0.1), step=0.09),
    Thing("table", (0.2, 0.2, 0.0), (1.2, 1.0, 0.7), (0.4, 0.3, 0.2), step=0.09),
)
APART = 6.0  # metres
HAZE = 120  # Gaussians


def street(rooms: int = 3, seed: int = 0) -> Scene:
    """Rooms along x. The last one has a piano in place of the table."""
    clouds: list[GaussianCloud] = []
    groups = []
    for k in range(rooms):
        last = k == rooms - 1
        walls = [replace(part, step=0.2) for part in shell(ceiling=False)]
        things = [*walls, THINGS[0], replace(THINGS[1], label="piano" if last else "table")]
        made = room(things)
        assert made.language is not None
        step = torch.tensor([APART * k, 0, 0])
        first = len(groups)
        clouds.append(made.cloud.replace(means=made.cloud.means + step, group=made.cloud.group + first))
        for g in made.language.groups:
            x, y, z = g.box.center
            groups.append(replace(g, id=g.id + first, box=replace(g.box, center=(x + APART * k, y, z))))
    rng = np.random.default_rng(seed)
    haze = clouds[0][torch.from_numpy(rng.integers(0, len(clouds[0]), HAZE))]
    spots = torch.from_numpy(rng.uniform([-2, -2, 0], [APART * (rooms - 1) + 2, 2, 2], (HAZE, 3))).float()
    clouds.append(haze.replace(means=spots, group=torch.full((HAZE,), NO_GROUP, dtype=torch.int32)))
    ends = np.cumsum([len(c) for c in clouds])
    cloud = concat([c.replace(ids=torch.arange(e - len(c), e)) for c, e in zip(clouds, ends, strict=True)])
    camera = Camera.look_at([0.5, -1.8, 1.6], [4, 1, 0.5], [0, 0, 1], 96, 64, 70, "door")
    field = LanguageField(tuple(groups), np.zeros((len(groups), 2), np.float32), "test:1")
    return Scene(cloud, made.frame, (camera,), field)


def saved_street(folder: Path, rooms: int = 3) -> Path:
    """The street as a .ply with its field."""
    scene = street(rooms)
    save(scene, folder / "street.ply")
    save_field(scene, folder / "street.ply")
    return folder / "street.ply"
