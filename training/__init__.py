"""Training of the embedded encoder: renders, captions, two towers, calibration, measurement. Run as a module."""
