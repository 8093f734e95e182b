"""The demo: furnishes a room, edits it with ten instructions, and checks their outcome."""
