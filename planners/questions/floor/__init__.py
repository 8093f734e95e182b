"""The free floor of a room: where people can walk, what fits, and what is in the way."""
