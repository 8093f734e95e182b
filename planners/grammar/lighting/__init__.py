"""Words about light: "turn the lamp on", "it's too dark in here", "a cosy evening mood", "brighter by a third"."""
