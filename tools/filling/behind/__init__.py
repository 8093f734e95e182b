"""What lies behind a thing and is of no plane: views of its place are completed as pictures and lifted."""
