"""Constitutive laws for granular matter, an MPM core that runs any of them, and the evidence for each."""
