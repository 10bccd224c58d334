#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The code of others in the packages, and its licences as SPDX writes them."""

import subprocess
from pathlib import Path

# Debian's source package of a shared library that a package carries: its name and its licence.
LIBRARIES = {
    "assimp": ("Open Asset Import Library", "BSD-3-Clause"),
    "draco": ("Draco", "Apache-2.0"),
    "fmtlib": ("{fmt}", "MIT"),
    "gmp": ("GNU MP", "LGPL-3.0-or-later OR GPL-2.0-or-later"),
    "libstb": ("stb", "MIT OR Unlicense"),
    "minizip": ("minizip", "Zlib"),
    "mpfr4": ("GNU MPFR", "LGPL-3.0-or-later"),
    "pugixml": ("pugixml", "MIT"),
    "tinygltf": ("TinyGLTF", "MIT"),
    "zlib": ("zlib", "Zlib"),
}


def package_of(library):
    """Debian's source package and version of a shared library, by its file name: ("assimp", "5.2.5~ds0-1")."""
    for folder in ("/usr/lib/x86_64-linux-gnu", "/lib/x86_64-linux-gnu"):
        path = Path(folder, library)
        for name in (path, path.resolve()):
            done = subprocess.run(["dpkg", "-S", name], capture_output=True, text=True, check=False)
            if done.returncode == 0:
                package = done.stdout.split(": ")[0].split(",")[0]
                shown = subprocess.check_output(["dpkg-query", "-W", "-f", "${source:Package} ${source:Version}", package], text=True)
                return tuple(shown.split())
    raise SystemExit(f"components: {library}: no Debian package holds it, so its licence is not known")


def libraries_in(folder):
    """{Debian's source package: its version} of the shared libraries that an unpacked package carries."""
    return dict(package_of(path.name) for path in sorted(folder.rglob("lib*.so.*")) if "libspherechain" not in path.name)


def expression(folder):
    """The SPDX expression of a wheel: the library, the tool and what lies beside the tool."""
    licences = sorted({LIBRARIES[package][1] for package in libraries_in(folder)} | {"Apache-2.0", "MPL-2.0"})
    others = [f"({licence})" if " OR " in licence else licence for licence in licences if licence != "MIT"]
    return " AND ".join(["MIT", "GPL-3.0-or-later", *others])
