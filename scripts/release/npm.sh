#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The npm packages: `scripts/release/npm.sh OUT`. `spherechain` is the library, with the command `npx spherechain`; the command
# finds the tool in a package of its platform, @spherechain/linux-x64, as esbuild does. Uses build/release, which it completes.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/release/common.sh
needs patchelf patchelf

build_tool
platform=linux-x64 library=build/release-stage/npm/library tool=build/release-stage/npm/tool
rm -rf build/release-stage/npm
mkdir -p build/release-stage/npm
cp -r build/release/javascript/spherechain $library
copy_notices $library/copyright
python3 scripts/release/tool_bundle.py $tool
mv $tool/share/doc/spherechain/LICENSE $tool/
cat >$tool/package.json <<END
{
  "name": "@spherechain/$platform",
  "version": "$version",
  "description": "The command line tool of spherechain for Linux on x86-64",
  "license": "GPL-3.0-or-later",
  "files": ["bin", "lib", "share"],
  "preferUnplugged": true,
  "os": ["linux"],
  "cpu": ["x64"],
  "libc": ["glibc"]
}
END
for package in $library $tool; do
  (cd $package && npm pack --silent --offline --pack-destination "$(realpath "$1")") | sed "s|^|$1/|"
done
