"""Final states of other MPM codes beside runs of this library: their points and surfaces, read and compared."""
