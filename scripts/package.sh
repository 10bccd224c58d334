#!/usr/bin/env bash
# Every package for Linux, into build/packages: libspherechain, libspherechain-dev and spherechain as .deb, the SDK and the tool
# as .tar.gz. `scripts/package.sh`. Uses build/release, which it completes; the shared library is built in build/package-shared.
# scripts/windows.sh makes the zip for Windows.
set -euo pipefail
cd "$(dirname "$0")/.."

cmake --preset release >/dev/null
cmake --build --preset release --target spherechain spherechain_runtime viewer
[[ -e build/release/share/spherechain/viewer.html ]] || { echo "package: build/release has no page of view: the tool's package would lack it" >&2; exit 1; }
cmake --preset release -B build/package-shared -D CMAKE_INSTALL_PREFIX=/usr -D BUILD_SHARED_LIBS=ON -D SPHERECHAIN_BAKER=OFF \
  -D SPHERECHAIN_TESTS=OFF -D SPHERECHAIN_CUDA=OFF >/dev/null
cmake --build build/package-shared
rm -rf build/packages
cpack --config build/package-shared/CPackConfig.cmake -G DEB -B "$PWD/build/packages" >/dev/null
cpack --config build/release/CPackConfig.cmake -G "DEB;TGZ" -B "$PWD/build/packages" >/dev/null
rm -rf build/packages/_CPack_Packages
ls -l build/packages
