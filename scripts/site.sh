#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The documents as a site that opens from disk, with a search and a live demo: `scripts/site.sh OUT`; open OUT/index.html. Needs
# Node 18 and npm. It installs the npm packages of scripts/site/package.json into build/site. Where SPHERECHAIN_TOOL names no tool,
# it builds one in build/release. The demo then needs emscripten, and a build/release that was not configured with
# SPHERECHAIN_JAVASCRIPT=OFF.
set -euo pipefail
cd "$(dirname "$0")/.."

out=${1:?usage: site.sh OUT}
if [[ -e $out && ! -e $out/search.js && -n $(ls -A "$out") ]]; then
  echo "site: $out: is there, and is no site of an earlier run; name another folder" >&2
  exit 1
fi
tool=${SPHERECHAIN_TOOL:-}
if [[ -z $tool ]]; then
  scripts/install_packages.sh
  cmake --preset release >/dev/null
  cmake --build --preset release --target spherechain viewer >/dev/null
  tool=build/release/bin/spherechain
fi

mkdir -p build/site
cp -r scripts/site/. build/site
if ! cmp -s scripts/site/package-lock.json build/site/installed; then
  echo "Installing the npm packages highlight.js, markdown-it, minisearch and playwright-core, and what they need, into build/site"
  npm --prefix build/site ci --ignore-scripts --loglevel=error >/dev/null
  cp scripts/site/package-lock.json build/site/installed
fi

work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
# The demo shows a MakeHuman body, whose exports are CC0, in movements of our own.
human=/usr/share/assimp/models/Collada/human.zae
"$tool" bake "$human" -o "$work/human.sphc" >/dev/null
"$tool" view "$work/human.sphc" --source "$human" --poses samples/poses/animation_arms.json -o "$work/human.html" >/dev/null
if ! grep -q data-runtime "$work/human.html"; then
  echo "site: $tool writes pages without a runtime, so that the demo would be dead: install emscripten, configure with -DSPHERECHAIN_JAVASCRIPT=ON, and build the target viewer" >&2
  exit 1
fi
node build/site/build.mjs . "$work/human.html" "$work/site"
rm -rf "$out"
mkdir -p "$(dirname "$out")"
cp -r "$work/site" "$out"
echo "Open $out/index.html in a browser."
