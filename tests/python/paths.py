# SPDX-License-Identifier: MIT
"""Where the tests' files are. CMake says it by the environment."""

import os
from pathlib import Path

GOLDEN = Path(__file__).resolve().parents[1] / "golden" / "0.1.0"
DOLL, PAPER_DOLL, DOLL_MESH = GOLDEN / "doll.sphc", GOLDEN / "doll_paper.sphc", GOLDEN / "doll.obj"
WRITE_TINY = os.environ["SPHERECHAIN_WRITE_TINY"]
REFERENCE = os.environ["SPHERECHAIN_REFERENCE"]
