"""From photographs with poses to a trained scene, on the CPU or a GPU: `take_photos`, then `fit`."""

from .fitting import Fitted, Settings, Status, fit
from .photographs.photos import Photos, take_photos

__all__ = ["Fitted", "Photos", "Settings", "Status", "fit", "take_photos"]
