"""The command line of grainlaw: thin, over materials, mpm_core and validation."""
