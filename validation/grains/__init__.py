"""Grains and material points on the same axes: readers of DEM dumps, coarse graining, observations and distances."""
