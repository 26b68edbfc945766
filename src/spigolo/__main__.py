"""Entry point of `python -m spigolo`, the same as `spigolo`."""

from spigolo.cli import main

main()
