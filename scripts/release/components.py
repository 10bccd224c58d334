#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The code of others in the packages, found where it comes from: the compiler's lists of headers, and the libraries that lie in a
package. Debian says the version; the licences stand here, by Debian's source package, as SPDX writes them."""

import functools
import json
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

LICENCES = {
    "assimp": "BSD-3-Clause",
    "boost1.74": "BSL-1.0",
    "cgal": "GPL-3.0-or-later AND LGPL-3.0-or-later",
    "cli11": "BSD-3-Clause",
    "draco": "Apache-2.0",
    "eigen3": "MPL-2.0",
    "flatbuffers": "Apache-2.0",
    "fmtlib": "MIT",
    "gmp": "LGPL-3.0-or-later OR GPL-2.0-or-later",
    "highway": "Apache-2.0",
    "libmd": "BSD-2-Clause AND BSD-3-Clause AND Beerware AND ISC",
    "libstb": "MIT OR Unlicense",
    "minizip": "Zlib",
    "mpfr4": "LGPL-3.0-or-later",
    "nanoflann": "BSD-2-Clause",
    "nlohmann-json3": "MIT",
    "pugixml": "MIT",
    "tinygltf": "MIT",
    "zlib": "Zlib",
}

# The compiler and its libraries: what it puts into a program is under the GCC Runtime Library Exception, or not copied.
TOOLCHAIN = {"gcc-12", "glibc", "linux", "python3.11"}


@functools.lru_cache(maxsize=None)
def source_of(package):
    """The source package and its version of one of Debian's packages."""
    shown = subprocess.check_output(["dpkg-query", "-W", "-f", "${source:Package} ${source:Version}", package], text=True)
    return tuple(shown.split())


def owners(paths):
    """{source package: version} of files of this machine."""
    asked = [str(path) for path in paths] + [str(path)[4:] for path in paths if str(path).startswith("/usr/lib")]
    done = subprocess.run(["dpkg", "-S", *asked], capture_output=True, text=True, check=False) if asked else None
    found = {}
    for line in done.stdout.splitlines() if done else ():
        name, version = source_of(line.split(": ")[0].split(",")[0])
        if name not in TOOLCHAIN:
            found[name] = version
    unknown = set(found) - set(LICENCES)
    if unknown:
        raise SystemExit(f"components: the licence of Debian's {min(unknown)} is not known: write it into components.py")
    return found


@functools.lru_cache(maxsize=None)
def compiled_in(*folders):
    """The packages whose headers the sources of these folders include, as build/release has compiled them."""
    deps = subprocess.check_output(["ninja", "-C", ROOT / "build" / "release", "-t", "deps"], text=True)
    headers, is_own = set(), False
    for line in deps.splitlines():
        if line and not line.startswith(" "):
            is_own = line.startswith(folders) and not line.startswith("runtime/python")
        elif is_own and line.strip().startswith("/usr/"):
            headers.add(line.strip())
    return owners(sorted(headers))


def libraries_in(folder):
    """The packages of the shared libraries that an unpacked package carries."""
    names = {path.name for path in folder.rglob("lib*.so.*") if "libspherechain" not in path.name}
    return owners([Path("/usr/lib/x86_64-linux-gnu", name) for name in sorted(names)])


# The npm packages that pages hold, by the notice that stays in a page or its script.
NOTICES = {"minisearch": b"Luca Ongaro", "three": b"Three.js Authors", "uplot": b"Leon Sorokin"}


def in_pages(pages):
    """[(name, version, licence)] of the npm packages that these web pages and scripts hold."""
    lock = {}
    for folder in ("baker/page/web", "scripts/site"):
        lock.update(json.loads((ROOT / folder / "package-lock.json").read_text())["packages"])
    texts = [page.read_bytes() for page in pages]
    bundled = {name: lock[f"node_modules/{name}"] for name, notice in NOTICES.items() if any(notice in text for text in texts)}
    return [(name, of["version"], of["license"]) for name, of in bundled.items()]


def expression(*found):
    """The SPDX expression of the library, the tool and these packages."""
    licences = sorted({LICENCES[package] for packages in found for package in packages} - {"MIT"})
    return " AND ".join(["MIT", "GPL-3.0-or-later", *(f"({licence})" if " OR " in licence else licence for licence in licences
                                                     if not re.search("GPL-3.0-or-later AND", licence))])
