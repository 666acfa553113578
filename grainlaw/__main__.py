"""`python -m grainlaw` is the command line."""

from grainlaw.cli import main

main()
