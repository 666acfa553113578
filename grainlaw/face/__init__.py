"""What `import grainlaw` gives: laws, element tests, scenes, runs and simulations for scripts and notebooks."""
