"""Laws against grains: fitted to DEM shear and compression, judged on DEM collapses that they were not fitted to."""
