"""Language models of transformers on this machine, with constrained decoding."""
