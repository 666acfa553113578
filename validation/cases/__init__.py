"""One file per validation case, each with its `CASE`."""
