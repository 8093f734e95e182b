"""Fit what an edit puts into a scene to its light: contact shadows, exposure, white balance, direction of light."""
