# SPDX-License-Identifier: MIT
"""`python -m spherechain bake hero.glb -o hero.sphc` runs the command line tool."""

import os
import sys

from ._process import program


def main() -> None:
    try:
        tool = program()
    except FileNotFoundError as error:
        sys.exit(f"spherechain: error: {error}")
    os.execv(tool, [tool, *sys.argv[1:]])


if __name__ == "__main__":
    main()
