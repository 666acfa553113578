"""Cases with references and bands: analytic, published and DEM; and the reports on them."""
