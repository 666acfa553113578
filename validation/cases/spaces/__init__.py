"""Cases in axisymmetry and three dimensions, and the same problem in several spaces."""
