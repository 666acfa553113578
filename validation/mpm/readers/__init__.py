"""Readers of files of points, one for each format; all return a `PointTable`."""
