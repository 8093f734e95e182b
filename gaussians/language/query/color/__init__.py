"""Selection by measured colour where a name cannot be resolved."""
