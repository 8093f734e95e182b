"""How one asset is made: mesh pieces, materials, patterns, sampling and baked light."""
