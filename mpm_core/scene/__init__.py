"""The scene: its model, files and errors, the shapes of bodies and their state at the start."""
