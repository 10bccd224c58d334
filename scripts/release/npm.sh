#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The npm packages: `scripts/release/npm.sh OUT`. `spherechain` is the library, with the command `npx spherechain`; the command
# finds the tool in a package of its platform, @spherechain/linux-x64, as esbuild does. Uses build/release, which it completes.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/release/common.sh
needs patchelf patchelf

build_tool
platform=linux-x64 stage=build/release-stage/npm
rm -rf $stage
python3 scripts/release/tool_bundle.py $stage
mv $stage/share/doc/spherechain/LICENSE $stage/
cat >$stage/package.json <<END
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
for package in build/release/javascript/spherechain $stage; do
  (cd $package && npm pack --silent --offline --pack-destination "$(realpath "$1")") | sed "s|^|$1/|"
done
