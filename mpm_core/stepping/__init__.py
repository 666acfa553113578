"""The time step, sleep, the loop from a scene to a folder, and what a run will cost."""
