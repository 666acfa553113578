"""Rigid obstacles of any shape, fixed, moved or free: their distance, their motion, contact and forces."""
