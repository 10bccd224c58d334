#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that a wheel keeps the rules of manylinux (PEP 600), as auditwheel does. `check_wheel.py WHEEL`.

Debian has no auditwheel, so its rules for x86-64 stand here: which libraries a wheel may expect, up to which versions of their
symbols, search paths that stay inside, a stack that is not executable, and tags and RECORD that agree with the files. Exits 1
and lists what is wrong. Needs readelf. `lowest_tag(FOLDER)` says which tag the files of an unpacked wheel may claim.
"""

import base64
import csv
import hashlib
import os
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

# Libraries that every Linux of a tag has.
ALLOWED = {
    "libatomic.so.1", "libgcc_s.so.1", "libstdc++.so.6", "libm.so.6", "libmvec.so.1", "libanl.so.1", "libdl.so.2", "librt.so.1",
    "libc.so.6", "libnsl.so.1", "libutil.so.1", "libpthread.so.0", "libX11.so.6", "libXext.so.6", "libXrender.so.1", "libICE.so.6",
    "libSM.so.6", "libGL.so.1", "libgobject-2.0.so.0", "libgthread-2.0.so.0", "libglib-2.0.so.0", "libresolv.so.2",
    "libexpat.so.1", "libz.so.1", "ld-linux-x86-64.so.2"}

# The newest version of each library's symbols, by tag.
POLICIES = {
    "manylinux_2_34_x86_64": {"GLIBC": "2.34", "GLIBCXX": "3.4.29", "CXXABI": "1.3.13", "GCC": "7.0.0", "ZLIB": "1.2.9"},
    "manylinux_2_35_x86_64": {"GLIBC": "2.35", "GLIBCXX": "3.4.30", "CXXABI": "1.3.13", "GCC": "12.0.0", "ZLIB": "1.2.9"},
    "manylinux_2_36_x86_64": {"GLIBC": "2.36", "GLIBCXX": "3.4.30", "CXXABI": "1.3.13", "GCC": "12.0.0", "ZLIB": "1.2.9"}}

# Symbols of zlib that some systems' zlib does not export.
PRIVATE_OF_ZLIB = {
    "_dist_code", "_length_code", "_tr_align", "_tr_flush_block", "_tr_init", "_tr_stored_block", "_tr_tally",
    "deflate_copyright", "inflate_copyright", "inflate_fast", "inflate_table", "z_errmsg", "zcalloc", "zcfree",
    "crc32_combine_gen", "crc32_combine_gen64", "crc32_combine_op"}


def number(version):
    return tuple(int(part) for part in version.split("."))


class Elf:
    """A program or a shared library, as readelf prints it."""

    def __init__(self, path):
        def read(*options):
            return subprocess.check_output(["readelf", "--wide", *options, path], text=True, env={**os.environ, "LC_ALL": "C"})

        dynamic, header = read("--dynamic"), read("--file-header", "--program-headers")
        self.path = path
        self.machine = re.search(r"Machine:\s+(.*)", header)[1]
        self.needed = re.findall(r"\(NEEDED\).*\[(.*)\]", dynamic)
        self.search = [part for found in re.findall(r"\((?:RPATH|RUNPATH)\).*\[(.*)\]", dynamic) for part in found.split(":")]
        self.stack = re.search(r"GNU_STACK.*\s(R\S*)\s+0x", header)
        self.has_text_relocations = "(TEXTREL)" in dynamic
        symbols = re.findall(r"\sUND\s+(\S+)", read("--dyn-syms"))
        self.undefined = {symbol.split("@")[0] for symbol in symbols}
        versions = [re.fullmatch(r"[^@]+@([A-Z]+)_([0-9.]+)", symbol) for symbol in symbols]
        self.versions = {(found[1], found[2]) for found in versions if found}
        self.versions |= set(re.findall(r"Name: ([A-Z]+)_([0-9.]+)\s", read("--version-info").split("Version needs section")[-1]))


def elves(folder):
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.open("rb").read(4) == b"\x7fELF":
            yield Elf(path)


def exceeding(found, policy):
    """The versions that a policy does not have."""
    return sorted(f"{library}_{version}" for library, version in found.versions
                  if library in policy and number(version) > number(policy[library]))


def lowest_tag(folder):
    for tag, policy in POLICIES.items():
        if not any(exceeding(elf, policy) for elf in elves(folder)):
            return tag
    raise SystemExit(f"check_wheel: {folder}: no tag up to {tag} has all versions of symbols that its files need")


def faults_of(elf, folder, policy):
    if elf.machine != "Advanced Micro Devices X86-64":
        yield f"is for {elf.machine}"
    yield from (f"needs {version}" for version in exceeding(elf, policy))
    for path in elf.search:
        inside = Path(os.path.normpath(path.replace("$ORIGIN", str(elf.path.parent))))
        if not path.startswith("$ORIGIN") or folder not in (inside, *inside.parents):
            yield f"searches {path}, outside of the wheel"
    places = [Path(path.replace("$ORIGIN", str(elf.path.parent))) for path in elf.search]
    for name in elf.needed:
        if name not in ALLOWED and not any((place / name).is_file() for place in places):
            yield f"needs {name}, which is neither allowed nor in the wheel"
    if elf.stack is None or "E" in elf.stack[1]:
        yield "has an executable stack"
    if elf.has_text_relocations:
        yield "has relocations in its code"
    yield from (f"needs zlib's private {symbol}" for symbol in sorted(elf.undefined & PRIVATE_OF_ZLIB))


def faults(wheel, folder):
    tag = wheel.stem.split("-", 2)[2]
    info = next(folder.glob("*.dist-info"))
    if f"Tag: {tag}\n" not in (info / "WHEEL").read_text():
        yield f"WHEEL lacks the name's tag {tag}"
    policy = POLICIES.get(tag.split("-")[-1])
    if policy is None:
        yield f"the platform of {tag} is none of {', '.join(POLICIES)}"
        return
    listed = {row[0]: row[1] for row in csv.reader((info / "RECORD").read_text().splitlines())}
    for path in folder.rglob("*"):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and path.name != "RECORD":
            digest = base64.urlsafe_b64encode(hashlib.sha256(path.read_bytes()).digest()).rstrip(b"=").decode()
            if listed.get(name) != f"sha256={digest}":
                yield f"{name}: RECORD has no or another hash"
    for elf in elves(folder):
        for fault in faults_of(elf, folder, policy):
            yield f"{elf.path.relative_to(folder)} {fault}"
        if elf.path.name.endswith(".abi3.so") and "-abi3-" not in wheel.name:
            yield "a module of the stable ABI in a wheel of another"


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    wheel = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(folder)
        found = list(faults(wheel, Path(folder)))
        for fault in found:
            print(f"check_wheel: {wheel.name}: {fault}", file=sys.stderr)
        if found:
            sys.exit(1)
        print(f"{wheel.name}: {sum(1 for _ in elves(Path(folder)))} ELF files keep the rules; the lowest honest tag is "
              f"{lowest_tag(Path(folder))}")


if __name__ == "__main__":
    main()
