"""What the dial's points are measured with, and how they are told in charts and in `docs/effort.md`."""
