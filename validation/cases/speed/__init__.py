"""What accuracy costs: one column collapse with many settings, errors against a finer one over processor time."""
