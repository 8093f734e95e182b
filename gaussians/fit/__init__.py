"""Train a scene on photographs, on the CPU or a GPU: `load_photos`, then `fit`."""

from .fitting import Fitted, Settings, Status, fit
from .photographs.photos import Photos, load_photos

__all__ = ["Fitted", "Photos", "Settings", "Status", "fit", "load_photos"]
