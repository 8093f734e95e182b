"""Language models behind a network address, in three wire formats."""
