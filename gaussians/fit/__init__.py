"""From photographs with poses to a trained scene, on the CPU."""
