"""Conformance: what every law has to satisfy, whatever it describes, checked on one point."""
