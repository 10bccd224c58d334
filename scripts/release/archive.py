#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Packs a folder: the same bytes from the same files, whenever and wherever. `archive.py FOLDER OUT.zip|OUT.tar.gz|OUT.tgz`.

The archive holds FOLDER's content under FOLDER's own name; a .zip with --flat holds the content alone. Times are that of the
newest commit, owners are root, files are sorted, and a file is executable or not; nothing else of the machine gets in.
"""

import argparse
import gzip
import os
import stat
import subprocess
import tarfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def release_time():
    """SOURCE_DATE_EPOCH, or the time of the newest commit."""
    given = os.environ.get("SOURCE_DATE_EPOCH")
    return int(given or subprocess.check_output(["git", "-C", str(ROOT), "log", "-1", "--format=%ct"]))


def mode(path):
    return 0o755 if path.stat().st_mode & stat.S_IXUSR else 0o644


def write_zip(files, out):
    moment = time.gmtime(release_time())[:6]
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, path in files:
            entry = zipfile.ZipInfo(name, moment)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3
            entry.external_attr = (stat.S_IFREG | mode(path)) << 16
            archive.writestr(entry, path.read_bytes())


def write_tar(files, out):
    with open(out, "wb") as raw, gzip.GzipFile("", "wb", 9, raw, mtime=0) as packed:
        with tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive:
            for name, path in files:
                entry = tarfile.TarInfo(name)
                entry.size, entry.mode, entry.mtime = path.stat().st_size, mode(path), release_time()
                entry.uname = entry.gname = "root"
                with path.open("rb") as content:
                    archive.addfile(entry, content)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--flat", action="store_true", help="the content alone, without the folder's name")
    arguments = parser.parse_args()
    folder = arguments.folder.resolve()
    base = folder if arguments.flat else folder.parent
    files = sorted((path.relative_to(base).as_posix(), path) for path in folder.rglob("*") if path.is_file())
    (write_zip if arguments.out.suffix == ".zip" else write_tar)(files, arguments.out)


if __name__ == "__main__":
    main()
