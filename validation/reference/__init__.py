"""The reference set of DEM collapses, shear and compression, as files and as read."""
