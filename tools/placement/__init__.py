"""Where things can be put: occupancy, support surfaces, walls and candidate regions."""
