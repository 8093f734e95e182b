"""Language over Gaussians: groups instead of a vector per Gaussian, and the queries that resolve to them."""
