"""Scene graphs of rooms: read them from scenes, check them, build them as Gaussians and resolve words in them."""
