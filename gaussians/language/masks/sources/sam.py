"""Masks by a Segment Anything model of transformers (`SamModel`): `sam:PATH-or-NAME`.

The images are the photographs of a capture if there is one, else rendered views of the scene. The masks have no labels;
the encoder names the groups they form. The model is prompted with a grid of points. Masks of low predicted IoU or low
stability, and duplicates, are discarded (Kirillov et al. 2023, section 5). The mask generation pipeline of transformers
is not used because it needs the compiled operators of torchvision.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from ....errors import BackendError, UserError
from ....files.captures.capture import Capture, read_capture
from ....scene import Scene
from ....torchvision_fix import import_torchvision
from ....viewpoints.pictures import Picture, read_photographs, render_views
from ..view import ViewMasks, pack_layers

SIDE = 640  # pixels: the longer side of renders and photographs
MAX_PHOTOS = 48  # of a capture, evenly spaced: more cost time and add little
POINTS_PER_SIDE = 16  # prompts along each side, half of SAM's default
BATCH = 64  # prompts at once
PRED_IOU_THRESH = 0.88  # least intersection over union that the model predicts of its mask
STABILITY_THRESH = 0.92  # least intersection over union of the masks at thresholds STABILITY_OFFSET above and below
STABILITY_OFFSET = 1.0  # logits
MIN_AREA = 0.0005  # of the image: smaller masks are discarded
NMS_IOU = 0.7  # intersection over union from which two masks are duplicates


def load(argument: str, capture: Path | None = None) -> Sam:
    """See `masks.load`.

    Raises:
        UserError: no model is given.
        BackendError: transformers is not installed, or the model does not exist.
        FileError: the capture does not exist.
    """
    if not argument:
        raise UserError("name the model: sam:PATH or sam:NAME, for example sam:facebook/sam-vit-base")
    place = Path(argument).expanduser()
    if not place.is_dir() and (place.is_absolute() or argument.startswith(".")):
        raise BackendError(f"there is no model at {place}; give sam:PATH of the folder of a transformers SamModel")
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
        advice = "give sam:PATH of the folder of a SamModel, or sam:NAME of one that can be downloaded"
        raise BackendError(f"cannot load the SAM {argument!r}: {error}; {advice}") from error
    return Sam(model.eval(), processor, taken)


@dataclass(frozen=True)
class Sam:
    """A loaded Segment Anything model.

    Attributes:
        model, processor: `SamModel` and `SamProcessor` of transformers.
        capture: the photographs to segment; None to render views.
        points_per_side: prompts along each side of an image.
        pred_iou_thresh, stability_thresh: see PRED_IOU_THRESH and STABILITY_THRESH.
    """

    model: Any
    processor: Any
    capture: Capture | None = None
    points_per_side: int = POINTS_PER_SIDE
    pred_iou_thresh: float = PRED_IOU_THRESH
    stability_thresh: float = STABILITY_THRESH

    def masks(
        self, scene: Scene, progress: Callable[[str, float], None] = lambda stage, share: None
    ) -> Iterator[ViewMasks]:
        """See `Masker`."""
        count, pictures = self._pictures(scene)
        for i, picture in enumerate(pictures):
            masks, scores = self.segment(picture.rgb)
            yield ViewMasks(picture.camera, pack_layers(masks), ("",) * len(masks), scores)
            progress("masks", (i + 1) / count)

    def segment(self, picture: NDArray[np.uint8]) -> tuple[NDArray[np.bool_], NDArray[np.float32]]:
        """Masks `[M, H, W]` of an image `[H, W, 3]` and their predicted IoUs `[M]`, highest first.

        Raises:
            BackendError: the model fails.
        """
        try:
            with torch.inference_mode():
                masks, scores = self._prompted(picture)
        except (RuntimeError, ValueError, IndexError, TypeError) as error:
            raise BackendError(f"SAM failed on an image of {picture.shape[1]}x{picture.shape[0]}: {error}") from error
        kept: list[int] = []
        for i in np.argsort(-scores, kind="stable").tolist():
            if all((masks[i] & masks[k]).sum() < NMS_IOU * (masks[i] | masks[k]).sum() for k in kept):
                kept.append(i)
        return masks[kept], scores[kept]

    def _prompted(self, picture: NDArray[np.uint8]) -> tuple[NDArray[np.bool_], NDArray[np.float32]]:
        """The masks above the thresholds from a grid of prompts, and their predicted IoUs."""
        height, width = picture.shape[:2]
        made = self.processor(images=picture, return_tensors="pt")
        shown = self.model.get_image_embeddings(made["pixel_values"])
        inner_height, inner_width = made["reshaped_input_sizes"][0].tolist()
        steps = (torch.arange(self.points_per_side) + 0.5) / self.points_per_side
        grid = torch.stack(torch.meshgrid(steps * inner_width, steps * inner_height, indexing="xy"), dim=-1)
        masks, scores = [np.zeros((0, height, width), bool)], [np.zeros(0, np.float32)]
        prompts_of = grid.reshape(-1, 1, 2)
        for start in range(0, len(prompts_of), BATCH):
            prompts = prompts_of[start : start + BATCH]
            answer = self.model(image_embeddings=shown, input_points=prompts[None], multimask_output=True)
            logits = self.processor.post_process_masks(
                answer.pred_masks, made["original_sizes"], made["reshaped_input_sizes"], binarize=False
            )[0].flatten(0, 1)  # [3 P, H, W]
            ious = answer.iou_scores.flatten().clamp(0, 1)
            above, below = ((logits > at).sum(dim=(1, 2)) for at in (STABILITY_OFFSET, -STABILITY_OFFSET))
            good = (ious >= self.pred_iou_thresh) & (above >= self.stability_thresh * below)
            good &= above >= MIN_AREA * height * width
            masks.append((logits[good] > 0).numpy())
            scores.append(ious[good].numpy().astype(np.float32))
        return np.concatenate(masks), np.concatenate(scores)

    def _pictures(self, scene: Scene) -> tuple[int, Iterator[Picture]]:
        """The number of pictures, or what it is at most, and the pictures."""
        if self.capture is None:
            return MAX_PHOTOS, render_views(scene, SIDE, MAX_PHOTOS)
        total = len(self.capture.cameras)
        chosen = np.unique(np.linspace(0, total - 1, min(MAX_PHOTOS, total)).round().astype(int))
        return len(chosen), read_photographs(self.capture, tuple(chosen.tolist()), SIDE)
