"""Makes a scene in tiles smaller part by part, at a PSNR that is measured in pictures of the whole."""

from .slimming import SlimmedTiles, slim_tiles

__all__ = ["SlimmedTiles", "slim_tiles"]
