"""Column collapses: what must not matter to them, finer grids, experiments, every law."""
