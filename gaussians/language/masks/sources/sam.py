"""Masks by a Segment Anything model of transformers (`SamModel`): `sam:PATH-or-NAME`.

Of the photographs of a capture, if there is one, else of rendered views of the scene itself. The masks have no names;
encoders look at the things they make up. A grid of points prompts the model; masks that it is unsure of, that change
with the threshold, or that another already covers are dropped (Kirillov et al. 2023, section 5; transformers' pipeline
of that name needs the compiled half of torchvision, this does not). Refuses to know Gaussians.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ....camera import Camera
from ....errors import BackendError, FileError, UserError
from ....files.captures.capture import Capture, read_capture
from ....render import render
from ....scene import Scene
from ....torchvision_fix import import_torchvision
from ....viewpoints.coverage import choose_views, fit_camera
from ..view import ViewMasks, packed

SIDE = 640  # pixels: the longer side of what is looked at, photographs included
MOST_PHOTOS = 48  # of a capture, evenly spaced: more add time and little else
POINTS = 16  # prompts along each side, half of SAM's usual number
BATCH = 64  # prompts at once
SURE = 0.88  # intersection over union that the model expects of its mask, at least
STABLE = 0.92  # intersection over union of the mask at thresholds OFFSET above and below, at least
OFFSET = 1.0  # logits
LEAST = 0.0005  # of the picture: smaller masks are specks
SAME = 0.7  # intersection over union from which two masks are one


def load(argument: str, capture: Path | None = None) -> Sam:
    """See `masks.load`.

    Raises:
        UserError: no model was named.
        BackendError: transformers is not installed, or there is no such model.
        FileError: the capture is not there.
    """
    if not argument:
        raise UserError("name the model: sam:PATH or sam:NAME, for example sam:facebook/sam-vit-base")
    place = Path(argument).expanduser()
    if not place.is_dir() and (place.is_absolute() or argument.startswith(".")):
        raise BackendError(f"there is no model at {place}; give sam:PATH of the folder of a SamModel of transformers")
    source = str(place) if place.is_dir() else argument
    taken = None if capture is None else read_capture(capture)
    import_torchvision()
    try:
        from transformers import SamModel, SamProcessor
    except (ImportError, RuntimeError) as error:
        raise BackendError(f"SAM needs transformers ({error}); run: pip install 'scenewright[models]'") from error
    try:
        model: Any = SamModel.from_pretrained(source)
        processor = SamProcessor.from_pretrained(source)
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        advice = "give sam:PATH of the folder of a SamModel, or sam:NAME of one that can be fetched"
        raise BackendError(f"cannot load the SAM {argument!r}: {error}; {advice}") from error
    return Sam(model.eval(), processor, taken)


@dataclass(frozen=True)
class Sam:
    """A loaded model.

    Attributes:
        model, processor: of transformers.
        capture: the photographs to look at; None renders views.
        points: prompts along each side of a picture.
        sure, stable: see SURE and STABLE.
    """

    model: Any
    processor: Any
    capture: Capture | None = None
    points: int = POINTS
    sure: float = SURE
    stable: float = STABLE

    def masks(
        self, scene: Scene, progress: Callable[[str, float], None] = lambda stage, share: None
    ) -> Iterator[ViewMasks]:
        """See `Masker`."""
        pictures = self._photos() if self.capture is not None else self._rendered(scene)
        for i, (camera, picture, count) in enumerate(pictures):
            masks, scores = self.segment(picture)
            yield ViewMasks(camera, packed(masks), ("",) * len(masks), scores)
            progress("masks", (i + 1) / count)

    def segment(self, picture: NDArray[np.uint8]) -> tuple[NDArray[np.bool_], NDArray[np.float32]]:
        """Masks `[M, H, W]` of a picture `[H, W, 3]`, surest first, and how sure the model is of each `[M]`.

        Raises:
            BackendError: the model failed.
        """
        try:
            with torch.inference_mode():
                masks, scores = self._prompted(picture)
        except (RuntimeError, ValueError, IndexError, TypeError) as error:
            raise BackendError(f"SAM failed on a picture of {picture.shape[1]}x{picture.shape[0]}: {error}") from error
        kept: list[int] = []
        for i in np.argsort(-scores, kind="stable").tolist():
            if all((masks[i] & masks[k]).sum() < SAME * (masks[i] | masks[k]).sum() for k in kept):
                kept.append(i)
        return masks[kept], scores[kept]

    def _prompted(self, picture: NDArray[np.uint8]) -> tuple[NDArray[np.bool_], NDArray[np.float32]]:
        """All masks worth keeping, over a grid of prompts, and their scores."""
        height, width = picture.shape[:2]
        made = self.processor(images=picture, return_tensors="pt")
        shown = self.model.get_image_embeddings(made["pixel_values"])
        inner_height, inner_width = made["reshaped_input_sizes"][0].tolist()
        steps = (torch.arange(self.points) + 0.5) / self.points
        grid = torch.stack(torch.meshgrid(steps * inner_width, steps * inner_height, indexing="xy"), dim=-1)
        masks, scores = [np.zeros((0, height, width), bool)], [np.zeros(0, np.float32)]
        prompts_of = grid.reshape(-1, 1, 2)
        for start in range(0, len(prompts_of), BATCH):
            prompts = prompts_of[start : start + BATCH]
            answer = self.model(image_embeddings=shown, input_points=prompts[None], multimask_output=True)
            logits = self.processor.post_process_masks(
                answer.pred_masks, made["original_sizes"], made["reshaped_input_sizes"], binarize=False
            )[0].flatten(0, 1)  # [3 P, H, W]
            sure = answer.iou_scores.flatten().clamp(0, 1)
            above, below = ((logits > at).sum(dim=(1, 2)) for at in (OFFSET, -OFFSET))
            good = (sure >= self.sure) & (above >= self.stable * below) & (above >= LEAST * height * width)
            masks.append((logits[good] > 0).numpy())
            scores.append(sure[good].numpy().astype(np.float32))
        return np.concatenate(masks), np.concatenate(scores)

    def _photos(self) -> Iterator[tuple[Camera, NDArray[np.uint8], int]]:
        from PIL import Image

        assert self.capture is not None
        total = len(self.capture.cameras)
        chosen = np.unique(np.linspace(0, total - 1, min(MOST_PHOTOS, total)).round().astype(int))
        for i in chosen:
            camera = _shrunk(self.capture.cameras[i])
            try:
                with Image.open(self.capture.photos[i]) as photo:
                    small = photo.convert("RGB").resize((camera.width, camera.height), Image.Resampling.LANCZOS)
            except OSError as error:
                raise FileError(f"cannot read the photograph {self.capture.photos[i]}: {error}") from error
            yield camera, np.asarray(small), len(chosen)

    def _rendered(self, scene: Scene) -> Iterator[tuple[Camera, NDArray[np.uint8], int]]:
        cameras = choose_views(scene).cameras
        for camera in cameras:
            gain = SIDE / max(camera.width, camera.height)
            large = fit_camera(camera, round(camera.width * gain), round(camera.height * gain))
            yield large, render(scene.cloud, large).to_uint8(), len(cameras)


def _shrunk(camera: Camera) -> Camera:
    gain = min(1.0, SIDE / max(camera.width, camera.height))
    return camera.resized(max(1, round(camera.width * gain)), max(1, round(camera.height * gain)))
