# SPDX-License-Identifier: MIT
"""Builds the wheel for pip: CMake compiles the module, this packs it (PEP 517, 427). Standard library alone.

The wheel that `pip wheel .` makes holds the library. scripts/release/wheel.sh makes the one that is published, with the tool.
"""

import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = "spherechain"
PYTHON_ABI = "cp39-abi3"  # the module is compiled for the stable ABI of 3.9 (src/python.h)

METADATA = """\
Metadata-Version: 2.4
Name: spherechain
Version: {version}
Summary: Self-collision of skinned characters: spheres, exact skin contacts, depth, and losses with gradients
License-Expression: {licence}
{licence_files}Requires-Python: >=3.9
Requires-Dist: numpy>=1.20
"""

WHEEL = """\
Wheel-Version: 1.0
Generator: spherechain
Root-Is-Purelib: false
Tag: {tag}
"""


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """With it pip looks for numpy first, and compiles where that is found."""
    info = Path(metadata_directory, info_folder())
    info.mkdir()
    Path(info, "METADATA").write_bytes(metadata("MIT", {"LICENSE"}))
    return info.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    python = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    platform = re.sub("[^0-9a-zA-Z]", "_", sysconfig.get_platform())
    return pack(wheel_directory, compile_package(ROOT / "build" / "wheel" / python), platform)


def pack(wheel_directory, package, platform, more=(), licences=(), licence="MIT"):
    """Returns the name of the wheel that it writes.

    package: folder of the compiled package. platform: "linux_x86_64". more: a folder of files that lie beside the package,
    with the tool. licences: a folder of their licences' texts. licence: the SPDX expression of all.
    """
    tag, info = f"{PYTHON_ABI}-{platform}", info_folder()
    files = {f"{PACKAGE}/{path.name}": path for path in package.iterdir() if path.is_file()}
    for folder, place in ((more, ""), (licences, f"{info}/licenses/")):
        files.update({f"{place}{path.relative_to(folder).as_posix()}": path for path in folder.rglob("*") if path.is_file()}
                     if folder else {})
    files[f"{info}/licenses/LICENSE"] = ROOT / "runtime" / "LICENSE"
    modes = {name: 0o100755 if path.stat().st_mode & 0o100 else 0o100644 for name, path in files.items()}
    files = {name: path.read_bytes() for name, path in sorted(files.items())}
    names = sorted(name.split("/licenses/")[1] for name in files if "/licenses/" in name)
    files[f"{info}/METADATA"] = metadata(licence, names)
    files[f"{info}/WHEEL"] = WHEEL.format(tag=tag).encode()
    if more:
        files[f"{info}/entry_points.txt"] = b"[console_scripts]\nspherechain = spherechain.__main__:main\n"
    files[f"{info}/RECORD"] = record(files, f"{info}/RECORD")
    name = f"{PACKAGE}-{version()}-{tag}.whl"
    with zipfile.ZipFile(Path(wheel_directory, name), "w", zipfile.ZIP_DEFLATED, compresslevel=9) as wheel:
        for path, data in files.items():
            entry = zipfile.ZipInfo(path)  # its date is 1980: the same files give the same wheel
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = modes.get(path, 0o100644) << 16
            wheel.writestr(entry, data)
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise NotImplementedError("the checkout is the source: pip install . or pip wheel .")


def version():
    return re.search(r"project\(spherechain VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


def info_folder():
    return f"{PACKAGE}-{version()}.dist-info"


def metadata(licence, licence_files):
    lines = "".join(f"License-File: {name}\n" for name in licence_files)
    return METADATA.format(version=version(), licence=licence, licence_files=lines).encode()


def compile_package(build):
    """Returns the folder of the package."""
    package = build / "python" / PACKAGE
    shutil.rmtree(package, ignore_errors=True)  # nothing of an older checkout
    generator = ["-G", "Ninja"] if shutil.which("ninja") and not (build / "CMakeCache.txt").exists() else []
    run("cmake", "-S", ROOT, "-B", build, *generator, "-DCMAKE_BUILD_TYPE=Release", "-DSPHERECHAIN_PYTHON=ON",
        f"-DPython_EXECUTABLE={sys.executable}", "-DSPHERECHAIN_BAKER=OFF", "-DSPHERECHAIN_TESTS=OFF",
        "-DSPHERECHAIN_CUDA=OFF")
    run("cmake", "--build", build, "--target", "spherechain_python", "--parallel", os.cpu_count() or 1)
    return package


def run(*command):
    subprocess.run([str(word) for word in command], check=True)


def record(files, own):
    lines = []
    for path, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        lines.append(f"{path},sha256={digest},{len(data)}\n")
    return "".join(lines + [f"{own},,\n"]).encode()
