"""One material point: element tests and return maps."""
