"""Planning by language models, behind one protocol (`backend.py`)."""
