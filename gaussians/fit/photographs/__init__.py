"""Photographs before training: reading, undistorting, pose checks and pose estimation."""
