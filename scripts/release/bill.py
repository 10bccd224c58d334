#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the bill of materials, SPDX 2.3 as JSON, and SHA256SUMS of a release: `bill.py FOLDER`.

Each file of FOLDER is a package there, with its checksum. It contains the code of others: the libraries that lie in it, and the
headers that the compiler took for build/release. The tool depends on libraries of others that it expects from the system. The document is
checked before it is written: names, checksums, identifiers, licences.
"""

import hashlib
import json
import re
import subprocess
import sys
import tarfile
import tempfile
import time
import uuid
import zipfile
from pathlib import Path

from archive import release_time
from check_wheel import Elf
import components

ROOT = Path(__file__).resolve().parents[2]
VERSION = re.search(r"project\(spherechain VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
KNOWN = {"MIT", "GPL-3.0-or-later", "LGPL-3.0-or-later", "GPL-2.0-or-later", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "BSL-1.0",
         "MPL-2.0", "Unlicense", "Zlib"}


def unpack(path, folder):
    if path.suffix == ".deb":
        subprocess.run(["dpkg-deb", "-x", path, folder], check=True)
    elif zipfile.is_zipfile(path):
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder)
    elif tarfile.is_tarfile(path):
        with tarfile.open(path) as archive:
            archive.extractall(folder)


def content(path):
    """The content of a package: (licence, {package of Debian: version} inside, the same that it expects, npm's packages)."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        unpack(path, folder)
        files = [file for file in folder.rglob("*") if file.is_file()]
        binaries = [file for file in files if file.open("rb").read(4)[:2] in (b"\x7fE", b"MZ") or file.suffix in (".a", ".wasm")]
        has_tool = any(file.name == "spherechain" and file in binaries for file in files)
        has_runtime = bool(binaries) or any(b"AGFzbQ" in file.read_bytes() for file in files if file.suffix in (".html", ".js"))
        inside, expected = dict(components.libraries_in(folder)), {}
        if has_runtime:
            inside.update(components.compiled_in("runtime/"))
        if has_tool:
            inside.update(components.compiled_in("runtime/", "baker/"))
            for file in binaries:
                if file.name == "spherechain":
                    carried = {other.name for other in files}
                    expected = components.owners([Path("/usr/lib/x86_64-linux-gnu", library) for library in Elf(file).needed
                                                  if library not in carried])
            inside = {name: version for name, version in inside.items() if name not in expected}
        # Debian has the text in /usr/share/common-licenses.
        if path.suffix != ".deb" and any(components.LICENCES[name] == "Apache-2.0" for name in inside) and not any(
                b"Version 2.0, January 2004" in file.read_bytes() for file in files):
            raise SystemExit(f"bill: {path}: it holds code under the Apache licence, but not the licence's text")
        pages = components.in_pages(file for file in files if file.suffix in (".html", ".js"))
        is_gpl = has_tool or "blender" in path.name
        licence = "MIT AND GPL-3.0-or-later" if path.suffix == ".whl" else "GPL-3.0-or-later" if is_gpl else "MIT"
        return licence, inside, expected, pages


class Document:
    def __init__(self):
        self.packages, self.relationships = {}, []

    def add(self, identifier, **fields):
        self.packages[identifier] = {"SPDXID": identifier, "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
                                     "copyrightText": "NOASSERTION", "supplier": "NOASSERTION", **fields}
        return identifier

    def relate(self, one, kind, other):
        self.relationships.append({"spdxElementId": one, "relationshipType": kind, "relatedSpdxElement": other})

    def component(self, source, name, version, licence):
        return self.add(identifier_of(source, name, version), name=name, versionInfo=version, licenseConcluded=licence,
                        licenseDeclared=licence, comment=f"From {source}.")


def identifier_of(*words):
    return "SPDXRef-" + re.sub("[^A-Za-z0-9.]+", "-", "-".join(words))


def write_document(folder):
    document = Document()
    sums = {}
    for path in sorted(file for file in folder.rglob("*") if file.is_file()):
        name = path.relative_to(folder).as_posix()
        sums[name] = hashlib.sha256(path.read_bytes()).hexdigest()
        licence, inside, expected, pages = content(path)
        own = document.add(identifier_of("Package", name), name=name, versionInfo=VERSION, packageFileName=name,
                           checksums=[{"algorithm": "SHA256", "checksumValue": sums[name]}], licenseConcluded=licence,
                           licenseDeclared=licence, primaryPackagePurpose="ARCHIVE", supplier="Organization: the spherechain authors",
                           copyrightText="2026 the spherechain authors")
        document.relate("SPDXRef-DOCUMENT", "DESCRIBES", own)
        for packages, kind in ((inside, "CONTAINS"), (expected, "DEPENDS_ON")):
            for package, version in sorted(packages.items()):
                document.relate(own, kind, document.component("Debian", package, version, components.LICENCES[package]))
        for package, version, licence in pages:
            document.relate(own, "CONTAINS", document.component("npm", package, version, licence))
    whole = "\n".join(f"{digest}  {name}" for name, digest in sums.items())
    out = {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"spherechain-{VERSION}",
           "documentNamespace": uuid.uuid5(uuid.NAMESPACE_OID, whole).urn,
           "creationInfo": {"created": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(release_time())),
                            "creators": ["Tool: spherechain scripts/release/bill.py", "Organization: the spherechain authors"]},
           "packages": list(document.packages.values()), "relationships": document.relationships}
    check(out)
    bill = folder / f"spherechain-{VERSION}.spdx.json"
    bill.write_text(json.dumps(out, indent=1) + "\n")
    sums[bill.name] = hashlib.sha256(bill.read_bytes()).hexdigest()
    (folder / "SHA256SUMS").write_text("".join(f"{digest}  {name}\n" for name, digest in sorted(sums.items())))
    print(f"{bill}: {len(out['packages'])} packages, {len(out['relationships'])} relations")


def check(document):
    """The rules of SPDX 2.3 for the fields that are used."""
    identifiers = [document["SPDXID"], *(package["SPDXID"] for package in document["packages"])]
    assert len(set(identifiers)) == len(identifiers), "an identifier stands twice"
    for identifier in identifiers:
        assert re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", identifier), identifier
    for package in document["packages"]:
        assert package["name"] and package["versionInfo"], package
        for field in ("licenseConcluded", "licenseDeclared"):
            words = set(re.findall(r"[^\s()]+", package[field])) - {"AND", "OR"}
            assert words <= KNOWN, (package["name"], words - KNOWN)
        for checksum in package.get("checksums", ()):
            assert re.fullmatch("[0-9a-f]{64}", checksum["checksumValue"]), checksum
    for relation in document["relationships"]:
        assert {relation["spdxElementId"], relation["relatedSpdxElement"]} <= set(identifiers), relation
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", document["creationInfo"]["created"])


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    write_document(Path(sys.argv[1]))
