"""Homogeneous element tests: one point of a law, led along a path of strain rates and held stresses."""
