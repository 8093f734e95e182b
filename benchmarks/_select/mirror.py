"""Mirrors a scene with its cameras and truth, so that only left and right are exchanged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import torch

from ...gaussians.camera import Camera
from ...gaussians.cloud import GaussianCloud
from .cases import Case

_FLIP = np.diag([-1.0, 1.0, 1.0])  # the plane x = 0 of the world


def mirrored(case: Case) -> Case:
    """The case in the mirror x = 0; its field is dropped, as it has to be found anew. Its own inverse."""
    scene = case.scene
    cameras = tuple(camera_in_mirror(c) for c in scene.cameras)
    up = scene.frame.up
    frame = replace(scene.frame, up=(-up[0], up[1], up[2]))
    objects = tuple(replace(o, position=(-o.position[0], *o.position[1:]), yaw=-o.yaw) for o in case.objects)
    cloud = cloud_in_mirror(scene.cloud)
    return replace(case, scene=scene.replace(cloud=cloud, frame=frame, cameras=cameras, language=None), objects=objects)


def cloud_in_mirror(cloud: GaussianCloud) -> GaussianCloud:
    """M R M is the turn about the mirrored axis the other way round: (w, x, -y, -z). Harmonics that are odd in x flip.

    With m < 0 for sines: Y_lm(-x, y, z) = (-1)^m Y_lm for m >= 0 and (-1)^(m+1) Y_lm for m < 0.
    """
    means = cloud.means * torch.tensor([-1.0, 1.0, 1.0])
    quats = cloud.quats * torch.tensor([1.0, 1.0, -1.0, -1.0])
    orders = [m for degree in range(cloud.degree + 1) for m in range(-degree, degree + 1)]
    signs = torch.tensor([(-1.0) ** (m if m >= 0 else m + 1) for m in orders])
    return cloud.replace(means=means, quats=quats, sh=cloud.sh * signs[:, None])


def camera_in_mirror(camera: Camera) -> Camera:
    """The mirrored eye, looking at the mirrored scene; its picture is the old one from right to left."""
    pose = np.eye(4)
    pose[:3, :3] = _FLIP @ camera.world_to_camera[:3, :3] @ _FLIP  # right = -M right, down = M down, ahead = M ahead
    pose[:3, 3] = -pose[:3, :3] @ (_FLIP @ camera.position)
    return replace(camera, world_to_camera=pose, cx=camera.width - camera.cx)
