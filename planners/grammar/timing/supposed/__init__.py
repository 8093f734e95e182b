"""What an instruction about time or motion may ask for, where no rule reads it: a kind of wish told by its words, and a
plain command of that kind."""
