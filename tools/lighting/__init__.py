"""Light as a re-weighting of colours: exposure, white balance, contrast, soft directional light, lamps and windows."""
