#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The recipes for vcpkg and Conan: `scripts/release/recipes.sh OUT`. Whoever publishes them fills in where the sources lie.
set -euo pipefail
cd "$(dirname "$0")/../.."
. scripts/release/common.sh
out=$(mkdir -p "$1" && cd "$1" && pwd)
recipes=scripts/release/recipes
for file in vcpkg/ports/spherechain/vcpkg.json conan/recipes/spherechain/config.yml conan/recipes/spherechain/all/conandata.yml; do
  grep -q "\"$version\"" $recipes/$file || { echo "recipes: $recipes/$file is of another version than $version" >&2; exit 1; }
done
rm -rf build/engines/recipes
mkdir -p build/engines
cp -r $recipes build/engines/recipes
find build/engines/recipes -name __pycache__ -prune -exec rm -rf {} +
cp runtime/LICENSE build/engines/recipes/
python3 scripts/release/archive.py build/engines/recipes "$out/spherechain-$version-recipes.zip"
echo "$out/spherechain-$version-recipes.zip"
