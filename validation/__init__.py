"""Cases with references and bands: analytic, published and DEM; and the reports on them."""

if __name__ == "validation":
    raise ImportError("import grainlaw.validation, not validation")
