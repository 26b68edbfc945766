"""Entry point of `python -m spigolo`, which runs the same program as the command `spigolo`."""

from spigolo.cli import main

main()
