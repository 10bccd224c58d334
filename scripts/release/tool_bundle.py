#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Collects the tool with the libraries that a stranger's Linux may lack. `tool_bundle.py FOLDER [LIBRARIES]`.

FOLDER gets bin/spherechain, share/spherechain with the pages, and share/doc/spherechain with the licences: of the tool, and of
each library's Debian package. LIBRARIES, FOLDER/lib/spherechain without it, gets the libraries. The tool finds both by
$ORIGIN, so that all may be moved together. Uses build/release; patchelf and strip.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from check_wheel import ALLOWED

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "release"
OWN = ROOT / "build" / "release-stage" / "libraries"  # what scripts/release/libraries compiles in place of Debian's
PAGES = ("viewer.html", "report_index.html", "report_clip.html", "report_score.html")


def libraries(program):
    """The shared libraries that a program loads here and that manylinux does not allow to expect: {name: path}."""
    listed = subprocess.check_output(["ldd", program], text=True, env={**os.environ, "LD_LIBRARY_PATH": str(OWN)})
    found = dict(re.findall(r"^\s+(\S+) => (\S+) \(", listed, re.M))
    return {name: Path(path) for name, path in found.items() if name not in ALLOWED}


def package_of(library):
    """The Debian package that holds a library of this machine, or whose source OWN has compiled."""
    installed = Path("/usr/lib/x86_64-linux-gnu", library.name).resolve()
    for path in (installed, Path("/lib", *installed.parts[3:])):
        done = subprocess.run(["dpkg", "-S", path], capture_output=True, text=True, check=False)
        if done.returncode == 0:
            return done.stdout.split(":")[0]
    raise SystemExit(f"tool_bundle: {library}: no Debian package holds it, so its licence is not known")


def place(source, target, library_folder):
    target.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run(["strip", "--strip-unneeded", "-o", target, source], check=True)
    target.chmod(0o755)
    origin = os.path.relpath(library_folder, target.parent)
    rpath = "$ORIGIN" if origin == "." else f"$ORIGIN/{origin}"
    subprocess.run(["patchelf", "--set-rpath", rpath, target], check=True)


def bundle(folder, library_folder):
    program = BUILD / "bin" / "spherechain"
    subprocess.run([ROOT / "scripts" / "release" / "libraries" / "assimp.sh", OWN], check=True)
    place(program, folder / "bin" / "spherechain", library_folder)
    (folder / "share" / "spherechain").mkdir(parents=True, exist_ok=True)
    for page in PAGES:
        shutil.copy(BUILD / "share" / "spherechain" / page, folder / "share" / "spherechain")
    licences = folder / "share" / "doc" / "spherechain"
    licences.mkdir(parents=True, exist_ok=True)
    for name in ("copyright", "LICENSE"):
        shutil.copy(ROOT / "baker" / name, licences / name)
    for name in ("Apache-2.0", "LGPL-3", "MPL-2.0"):  # the copyright files refer to these texts on Debian
        shutil.copy(f"/usr/share/common-licenses/{name}", licences / name)
    for name, path in libraries(program).items():
        place(path.resolve(), library_folder / name, library_folder)
        package = package_of(path)
        shutil.copy(f"/usr/share/doc/{package}/copyright", licences / f"copyright.{package}")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    own = Path(sys.argv[1]).absolute()
    bundle(own, Path(sys.argv[2]).absolute() if len(sys.argv) == 3 else own / "lib" / "spherechain")
