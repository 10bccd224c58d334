#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks the descriptor of an unpacked Unreal plugin: `check_plugin.py PLUGIN`. Prints what is wrong, and exits with 1."""
import json
import re
import sys
from pathlib import Path

# Unreal reads these keys, of these types (FPluginDescriptor, FModuleDescriptor).
PLUGIN = {"FileVersion": int, "Version": int, "VersionName": str, "FriendlyName": str, "Description": str, "Category": str,
          "CreatedBy": str, "CreatedByURL": str, "DocsURL": str, "MarketplaceURL": str, "SupportURL": str, "EngineVersion": str,
          "CanContainContent": bool, "IsBetaVersion": bool, "IsExperimentalVersion": bool, "Installed": bool,
          "EnabledByDefault": bool, "SupportedTargetPlatforms": list, "Modules": list, "Plugins": list}
MODULE = {"Name": str, "Type": str, "LoadingPhase": str, "PlatformAllowList": list, "PlatformDenyList": list}
TYPES = {"Runtime", "RuntimeNoCommandlet", "Developer", "Editor", "EditorNoCommandlet", "UncookedOnly", "Program"}
PHASES = {"Default", "PostDefault", "PreDefault", "PreLoadingScreen", "PostEngineInit", "PostConfigInit", "EarliestPossible"}

plugin = Path(sys.argv[1])
descriptor = json.loads((plugin / "Spherechain.uplugin").read_text())
wrong = []


def check(what, known, where):
    for key, value in what.items():
        if key not in known or type(value) is not known[key]:
            wrong.append("%s: the key %s" % (where, key))


check(descriptor, PLUGIN, "the plugin")
if descriptor["FileVersion"] != 3 or not re.fullmatch(r"\d+\.\d+\.\d+", descriptor["VersionName"]) or descriptor["VersionName"] == "0.0.0":
    wrong.append("the plugin: a version")
for module in descriptor["Modules"]:
    check(module, MODULE, module["Name"])
    folder = plugin / "Source" / module["Name"]
    if module["Type"] not in TYPES or module.get("LoadingPhase") not in PHASES:
        wrong.append("%s: its type or phase" % module["Name"])
    sources = "".join(path.read_text() for path in folder.rglob("*.cpp"))
    if not (folder / (module["Name"] + ".Build.cs")).is_file() or not re.search(r"IMPLEMENT_MODULE\(\w+, %s\)" % module["Name"], sources):
        wrong.append("%s: no rules, or no IMPLEMENT_MODULE" % module["Name"])
# Unreal's tool demands that the generated header comes last, once, wherever there is a reflected type.
for header in (plugin / "Source").rglob("*.h"):
    text = header.read_text(errors="replace")
    includes = re.findall(r'#include [<"]([^>"]+)[>"]', text)
    reflected = re.search(r"^(UCLASS|USTRUCT|UENUM)\(", text, re.M)
    if bool(reflected) != ("%s.generated.h" % header.stem in includes) or (reflected and includes[-1] != "%s.generated.h" % header.stem):
        wrong.append("%s: its generated header" % header.name)
    if reflected and len(re.findall(r"^(?:UCLASS|USTRUCT)\(", text, re.M)) != text.count("GENERATED_BODY()"):
        wrong.append("%s: GENERATED_BODY()" % header.name)
for line in wrong:
    print("FAILED: " + line)
print("%s %s: %d modules" % (descriptor["FriendlyName"], descriptor["VersionName"], len(descriptor["Modules"])))
sys.exit(1 if wrong else 0)
