"""Scenes whose solution is known."""
