"""Takes out of spoken instructions what carries no meaning: hesitation, remarks, slips that the speaker takes back."""
