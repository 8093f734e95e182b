"""The encoder back ends, one module each; `encoders.names` lists the modules of this package."""
