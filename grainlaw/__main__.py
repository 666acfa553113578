"""`python -m grainlaw` is the command line."""

from grainlaw.cli.main import main

main()
