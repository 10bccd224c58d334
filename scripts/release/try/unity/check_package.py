#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks an unpacked Unity package: `check_package.py PACKAGE`. Prints what is wrong, and exits with 1."""
import json
import re
import sys
from pathlib import Path

package = Path(sys.argv[1])
wrong = []
manifest = json.loads((package / "package.json").read_text())
if not re.fullmatch(r"com\.[a-z0-9.-]+", manifest["name"]):
    wrong.append("package.json: name")
if not re.fullmatch(r"\d+\.\d+\.\d+", manifest["version"]) or manifest["version"] == "0.0.0":
    wrong.append("package.json: version")
if not re.fullmatch(r"20\d\d\.\d", manifest["unity"]):
    wrong.append("package.json: unity")
for sample in manifest["samples"]:
    if set(sample) != {"displayName", "description", "path"} or not list((package / sample["path"]).glob("*.cs")):
        wrong.append("package.json: the sample %s" % sample)
for name in ["README.md", "CHANGELOG.md", "LICENSE.md", "Third Party Notices.md", "Documentation~/index.md", "Runtime/Spherechain.asmdef"]:
    if not (package / name).is_file():
        wrong.append(name + " is missing")

guids = {}
enabled = {}
for path in sorted(package.rglob("*")):
    inside = path.relative_to(package)
    if path.suffix == ".meta":
        if not path.with_suffix("").exists():
            wrong.append("%s is of nothing" % inside)
        continue
    if inside.parts[0].endswith("~") and inside.parts[0] != "Samples~" or inside.as_posix() == "Samples~":
        continue
    meta = path.with_name(path.name + ".meta")
    if not meta.is_file():
        wrong.append("%s has no .meta" % inside)
        continue
    text = meta.read_text()
    guid = re.search(r"^guid: ([0-9a-f]{32})$", text, re.M)
    if not guid or guid.group(1) in guids:
        wrong.append("%s: its GUID is none, or that of %s" % (inside, guids.get(guid and guid.group(1))))
    else:
        guids[guid.group(1)] = inside
    if path.is_dir() != ("folderAsset: yes" in text):
        wrong.append("%s: folderAsset" % inside)
    if "Plugins" in inside.parts and path.is_file():
        enabled[path.name] = re.findall(r"- first:\n      (\S+): (\S+)\n    second:\n      enabled: 1", text)
expected = {"libspherechain.so": [("Editor", "Editor"), ("Standalone", "Linux64")],
            "spherechain.dll": [("Editor", "Editor"), ("Standalone", "Win64")], "libspherechain.a": [("WebGL", "WebGL")]}
if enabled != expected:
    wrong.append("the libraries are enabled for %s" % enabled)
for line in wrong:
    print("FAILED: " + line)
print("%s %s: %d files and folders with a GUID" % (manifest["name"], manifest["version"], len(guids)))
sys.exit(1 if wrong else 0)
