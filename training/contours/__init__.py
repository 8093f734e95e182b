"""Train the contour network: where borders between two things run in a picture, whatever the things are.

`python -m scenewright.training.contours --out FILE` renders pictures with true instance borders, trains a small network
on them, exports it as ONNX and measures it on pictures that it has not seen.
"""
