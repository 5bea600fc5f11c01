"""python -m sgmp_view."""

from .command import main

main()
