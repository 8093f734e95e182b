"""The free floor of a room: where people can walk, by which way, and what would still fit."""
