"""Discrete element runs of our own: one case description, decks for LIGGGHTS and YADE, and their runners."""
