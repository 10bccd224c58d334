#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes a .meta file for each file and folder of a Unity package: `unity_metas.py PACKAGE`.

A GUID is the hash of the package's name and the file's path, so it stays the same in each release. Unity ignores folders whose
name ends with ~. Samples~ gets files all the same, because Unity copies the samples into the project.
"""
import hashlib
import json
import sys
from pathlib import Path

TAIL = "  userData: \n  assetBundleName: \n  assetBundleVariant: \n"
PLATFORMS = ["Linux64", "OSXUniversal", "Win", "Win64"]
# The build target of each native library, and the editor that loads it.
PLUGINS = {"Linux/x86_64": ("Linux64", "Linux"), "Windows/x86_64": ("Win64", "Windows"), "WebGL": ("WebGL", None)}


def entry(first, enabled, settings):
    lines = ["  - first:", "      %s" % first, "    second:", "      enabled: %d" % enabled]
    if not settings:
        return lines + ["      settings: {}"]
    return lines + ["      settings:"] + ["        %s: %s" % setting for setting in settings]


def plugin(path):
    folder = next(name for name in PLUGINS if path.parent.as_posix().endswith("Plugins/" + name))
    target, editor = PLUGINS[folder]
    excluded = [("Exclude %s" % name, int(name not in (target, "Editor" if editor else None)))
                for name in ["Editor"] + PLATFORMS[:2] + ["WebGL"] + PLATFORMS[2:]]
    lines = ["PluginImporter:", "  externalObjects: {}", "  serializedVersion: 2", "  iconMap: {}", "  executionOrder: {}",
             "  defineConstraints: []", "  isPreloaded: 0", "  isOverridable: 0", "  isExplicitlyReferenced: 0",
             "  validateReferences: 1", "  platformData:"]
    lines += entry(": Any", 0, excluded)
    lines += entry("Any: ", 0, [])
    lines += entry("Editor: Editor", bool(editor), [("CPU", "x86_64" if editor else "AnyCPU"), ("DefaultValueInitialized", "true"),
                                                    ("OS", editor or "AnyOS")])
    for name in PLATFORMS:
        lines += entry("Standalone: " + name, name == target, [("CPU", "x86_64" if name == target else "None")])
    if target == "WebGL":
        lines += entry("WebGL: WebGL", 1, [])
    return "\n".join(lines) + "\n" + TAIL


def importer(path):
    if path.is_dir():
        return "folderAsset: yes\nDefaultImporter:\n  externalObjects: {}\n" + TAIL
    if "Plugins" in path.parts:
        return plugin(path)
    if path.suffix == ".cs":
        return ("MonoImporter:\n  externalObjects: {}\n  serializedVersion: 2\n  defaultReferences: []\n  executionOrder: 0\n"
                "  icon: {instanceID: 0}\n" + TAIL)
    kinds = {".asmdef": "AssemblyDefinitionImporter", ".md": "TextScriptImporter", ".txt": "TextScriptImporter"}
    kind = "PackageManifestImporter" if path.name == "package.json" else kinds.get(path.suffix, "DefaultImporter")
    return "%s:\n  externalObjects: {}\n%s" % (kind, TAIL)


def main(package):
    name = json.loads((package / "package.json").read_text())["name"]
    for path in sorted(package.rglob("*")):
        inside = path.relative_to(package)
        if path.suffix == ".meta" or inside.parts[0].endswith("~") and (inside.parts[0] != "Samples~" or len(inside.parts) == 1):
            continue
        guid = hashlib.md5(("%s/%s" % (name, inside.as_posix())).encode()).hexdigest()
        path.with_name(path.name + ".meta").write_text("fileFormatVersion: 2\nguid: %s\n%s" % (guid, importer(path)))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
