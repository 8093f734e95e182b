"""Selection in captures of real places: outlines drawn by hand, words of people, and what both come to."""
