"""Balls of one colour each, and an encoder that tells reddish from greenish pictures."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from scenewright.gaussians.cloud import GaussianCloud
from scenewright.gaussians.language.encoders import Encoder
from scenewright.gaussians.language.encoders.calibration import Calibration
from scenewright.gaussians.language.encoders.vocabulary import Vocabulary
from scenewright.gaussians.language.field.language_field import Group, LanguageField
from scenewright.gaussians.language.field.making import Making, MaskSource
from scenewright.gaussians.scene import Frame, Scene
from scenewright.gaussians.world.box import Box

BOX = Box((0.0, 0.0, 0.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.4, 0.4, 0.9))


class Hues:
    """Tells reddish from greenish pictures and knows a word for each."""

    fingerprint = "hues:1"
    dim = 2
    image_size = 16
    vocabulary = Vocabulary({"tomato": (), "cucumber": ()}, {}, ())
    calibration = Calibration(scale=20.0, threshold=0.5)

    def encode_text(self, texts: list[str]) -> NDArray[np.float32]:
        return np.array([[1, 0] if "tomato" in t else [0, 1] for t in texts], np.float32)

    def encode_images(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        hue = images[..., :2].reshape(len(images), -1, 2).mean(axis=1).astype(np.float32) - 100
        return (hue / np.linalg.norm(hue, axis=1, keepdims=True)).astype(np.float32)

    def unknown_words(self, text: str) -> tuple[str, ...]:
        return tuple(w for w in text.split() if w not in self.vocabulary.names)

    def knows(self, text: str) -> bool:
        return not self.unknown_words(text)


HUES: Encoder = Hues()


def things(*colors: tuple[float, float, float], votes: tuple[tuple[str, float], ...] = ()) -> Scene:
    """A ball of Gaussians of each colour, embedded under an encoder that named none of them."""
    rng = np.random.default_rng(0)
    points = np.concatenate([rng.normal((3 * i, 0, 0), 0.3, (200, 3)) for i in range(len(colors))])
    dc = (np.repeat(np.array(colors), 200, axis=0) - 0.5) / 0.28209479
    n = len(points)
    cloud = GaussianCloud.create(
        torch.from_numpy(points).float(), torch.tensor([[1.0, 0, 0, 0]]).repeat(n, 1), torch.full((n, 3), 0.05),
        torch.full((n,), 0.95), torch.from_numpy(dc[:, None]).float().contiguous(),
        torch.arange(len(colors), dtype=torch.int32).repeat_interleave(200),
    )  # fmt: skip
    groups = tuple(
        Group(i, "object", -1, "", 0.0, BOX, (50.0, 0.0, 0.0), 200, 2, 1.0, votes=votes) for i in range(len(colors))
    )
    making = Making("none", (MaskSource("folder:masks", 3, 5),))
    field = LanguageField(groups, np.zeros((len(colors), 3), np.float32), "none:1", ("a note",), making)
    return Scene(cloud, Frame((0, 0, 1), -1.0, 1.0, "given", "given"), language=field)


RED, GREEN = (0.9, 0.1, 0.1), (0.1, 0.8, 0.1)
