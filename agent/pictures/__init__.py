"""Pictures and films of a scene: named cameras, the cameras of films, contact sheets and image files."""
