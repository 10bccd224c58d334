# SPDX-License-Identifier: MIT
"""The wheel of the package that this build compiled: pip installs it without a network, whole and typed."""

import csv
import os
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

import spherechain

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "runtime" / "python"))
import build_wheel  # noqa: E402


class Wheel(unittest.TestCase):
    def test_installs_and_imports(self):
        compiled = Path(spherechain.__file__).parent
        build_wheel.compile_package = lambda build: compiled  # that takes half a minute, and is done
        with tempfile.TemporaryDirectory() as folder:
            first = Path(folder, build_wheel.build_wheel(folder))
            data = first.read_bytes()
            build_wheel.build_wheel(folder)
            self.assertEqual(first.read_bytes(), data)
            with zipfile.ZipFile(first) as wheel:
                names = set(wheel.namelist())
                record = next(name for name in names if name.endswith("RECORD"))
                self.assertEqual({row[0] for row in csv.reader(wheel.read(record).decode().splitlines())}, names)
            for name in ("__init__.py", "torch.py", "py.typed", "_native.pyi"):
                self.assertIn(f"spherechain/{name}", names)
            self.assertFalse([name for name in names if "pycache" in name])
            target = Path(folder, "site")
            pip = [sys.executable, "-m", "pip", "install", "--no-index", "--no-deps", "--quiet", "--target", target, first]
            environment = {**os.environ, "PIP_ROOT_USER_ACTION": "ignore"}
            subprocess.run(pip, check=True, capture_output=True, env=environment)
            asset = ROOT / "tests" / "golden" / "0.1.0" / "doll.sphc"
            code = f"import spherechain; print(spherechain.__file__, spherechain.Model({str(asset)!r}).sphere_count)"
            done = subprocess.run([sys.executable, "-c", code], env={**environment, "PYTHONPATH": str(target)}, text=True,
                                  capture_output=True, check=True)
            self.assertEqual(done.stdout.split(), [str(target / "spherechain" / "__init__.py"), "64"])

    def test_numpy_is_looked_for_before_anything_is_compiled(self):
        with tempfile.TemporaryDirectory() as folder:
            for program in ("cmake", "ninja"):  # pip must not come to them
                Path(folder, program).symlink_to("/bin/false")
            pip = [sys.executable, "-m", "pip", "install", "--no-index", "--ignore-installed", "--target", Path(folder, "site"), ROOT]
            environment = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}", "PIP_FIND_LINKS": ""}
            done = subprocess.run(pip, env=environment, text=True, capture_output=True)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn("No matching distribution found for numpy", done.stderr)


if __name__ == "__main__":
    unittest.main()
