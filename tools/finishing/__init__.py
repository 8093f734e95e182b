"""Materials as procedural textures on the surfaces of a selection: wood, marble, brick, cloth, patterns."""
