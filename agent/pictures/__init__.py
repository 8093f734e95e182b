"""Pictures and films of a scene: cameras by name, shots, contact sheets and files."""
