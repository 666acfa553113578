"""What stands in the way: planes at any angle, silos."""
