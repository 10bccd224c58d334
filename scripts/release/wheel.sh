#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The Python wheel with the tool inside, for Python 3.9 and newer: `scripts/release/wheel.sh OUT`. Uses build/release and
# build/wheel, which it completes. Installs patchelf where it may.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/release/common.sh
needs patchelf patchelf

build_tool
stage=build/release-stage/wheel
rm -rf $stage
mkdir -p $stage/files $stage/licences
python3 scripts/release/tool_bundle.py $stage/files/spherechain/tool $stage/files/spherechain.libs
mv $stage/files/spherechain/tool/share/doc/spherechain $stage/licences/tool
rmdir $stage/files/spherechain/tool/share/doc
/usr/bin/python3 - "$1" $stage "$version" <<'END'
import sys
from pathlib import Path
sys.path[:0] = ["runtime/python", "scripts/release"]
import build_wheel, check_wheel, components

out, stage, version = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
package = build_wheel.compile_package(Path("build/wheel").absolute())
tag = max(check_wheel.lowest_tag(folder) for folder in (stage / "files", package))
for old in Path(out).glob(f"spherechain-{version}-*.whl"):
    old.unlink()
name = build_wheel.pack(out, package, tag, stage / "files", stage / "licences", components.expression(components.libraries_in(stage / "files"), components.compiled_in("baker/", "runtime/")))
print(Path(out, name))
END
python3 scripts/release/check_wheel.py "$1"/spherechain-"$version"-*.whl
