"""Fill what an edit reveals: surfaces are continued where a thing that is gone hid them."""
