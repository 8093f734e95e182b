"""What knows pictures: denoisers by specification. `sds.Denoiser` is what each of them offers."""

from __future__ import annotations

from pathlib import Path

from ...errors import BackendError
from ..sds import Denoiser
from .text_to_image import GUIDANCE


def load(spec: str, prompt: str, image: Path | None = None, guidance: float = GUIDANCE) -> Denoiser:
    """A denoiser for an object.

    Args:
        spec: "diffusers:FOLDER", a pipeline saved by diffusers: Stable Diffusion 1 or 2 for words, Stable Diffusion
            Image Variations for a picture.
        prompt: what the object is.
        image: photograph or drawing of it, for pipelines that take one.
        guidance: weight of the words (classifier-free guidance).

    Raises:
        BackendError: unknown back end, or the pipeline cannot be loaded or is of another class.
        UserError: the picture cannot be read.
    """
    name, _, folder = spec.partition(":")
    if name != "diffusers" or not folder:
        raise BackendError(
            f"unknown model {spec!r} to dream with; use diffusers:FOLDER (a folder with a text-to-image pipeline), "
            'command:"PROGRAM {prompt} {output}", or library'
        )
    if image is None:
        from .text_to_image import TextToImage

        return TextToImage.load(folder, prompt, guidance)
    from .image_variation import ImageVariation

    return ImageVariation.load(folder, image, guidance)
