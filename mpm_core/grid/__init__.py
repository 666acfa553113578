"""The background grid and the nodes of it that are active."""
