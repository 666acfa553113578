"""Readers of DEM dumps, one file for each format; all return `GrainSnapshot`."""
