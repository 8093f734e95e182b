"""What happens in a scene with time, as questions see it: bodies, happenings and moments."""
