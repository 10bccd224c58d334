# SPDX-License-Identifier: MIT
"""bake() and check() with the tool itself, where there is one."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import spherechain

from palettes import random_poses
from paths import DOLL, DOLL_MESH

TOOL = os.environ.get("SPHERECHAIN_TOOL") or shutil.which("spherechain")


class NoTool(unittest.TestCase):
    def test_says_where_it_is_looked_for(self):
        with mock.patch.dict(os.environ, {"SPHERECHAIN_TOOL": "/nowhere/spherechain"}):
            with self.assertRaisesRegex(FileNotFoundError, "/nowhere/spherechain: no such program. Pass tool="):
                spherechain.bake(DOLL_MESH)


@unittest.skipUnless(TOOL, "skipped: the tool is missing (SPHERECHAIN_TOOL)")
class Tool(unittest.TestCase):
    def test_bakes_with_settings_and_checks(self):
        with tempfile.TemporaryDirectory() as folder:
            output, preview = Path(folder, "doll.sphc"), Path(folder, "doll.glb")
            model, report = spherechain.bake(DOLL_MESH, output, tool=TOOL, extremities=False, penetration_depth=0.2,
                                             preview=preview)
            self.assertEqual(spherechain.Model(output).sphere_count, model.sphere_count)
            self.assertIn('"penetration_depth":0.2', model.settings)
            self.assertIn('"extremities":false', model.settings)
            self.assertEqual(report["missed_targets"], [])
            result = spherechain.check(preview, tool=TOOL, output=Path(folder, "report"), max_depth=5)
            self.assertEqual(result["summary"]["characters"], 1)
            self.assertFalse(result["summary"]["fails"])
            self.assertTrue(Path(folder, "report").is_dir())

    def test_penetrations_are_the_faults_that_play_reports(self):
        model = spherechain.Model(DOLL)
        # The doll's vertices are the corners of its triangles, one after another.
        corners = np.repeat(np.arange(model.triangle_count), 3), np.tile(np.eye(3, dtype=np.float32), (model.triangle_count, 1))
        poses = model.points(random_poses(model, 8, 80), *corners)
        with tempfile.TemporaryDirectory() as folder:
            for i, pose in enumerate(poses):
                lines = ["v %.9g %.9g %.9g" % tuple(vertex) for vertex in pose]
                lines += ["f %d %d %d" % (3 * k + 1, 3 * k + 2, 3 * k + 3) for k in range(model.triangle_count)]
                Path(folder, f"{i}.obj").write_text("\n".join(lines))
            result = Path(folder, "play.json")
            subprocess.run([TOOL, "play", DOLL, "--source", DOLL_MESH, "--poses", folder, "--frames", "9", "--json", result],
                           check=True, capture_output=True)
            frames = json.loads(result.read_text())["frames"][1:]  # the first is the rest pose
        faults = [[(*entry["parts"], entry["class"], entry["depth_mm"]) for entry in frame["penetrations"]
                   if entry["class"] in spherechain.FAULTS] for frame in frames]
        last, found = None, []
        for pose in poses:
            last = model.penetrations(vertices=pose, previous=last)
            found.append([(entry.part, entry.other, entry.kind, entry.depth_mm) for entry in last])
        self.assertGreater(sum(map(len, found)), 10)
        for own, expected in zip(map(sorted, found), map(sorted, faults)):
            self.assertEqual([entry[:3] for entry in own], [entry[:3] for entry in expected])
            np.testing.assert_allclose([entry[3] for entry in own], [entry[3] for entry in expected], rtol=1e-6)

    def test_runs_without_numpy(self):
        def python(code):
            hidden = f"import runpy, sys; sys.modules['numpy'] = None; {code}"
            return subprocess.run([sys.executable, "-c", hidden, "--version"], text=True, capture_output=True)

        done = python("runpy.run_module('spherechain', run_name='__main__', alter_sys=True)")
        self.assertEqual((done.returncode, done.stdout.split()[:1]), (0, ["spherechain"]), done.stderr)
        done = python("from spherechain import Model")
        self.assertIn("spherechain.Model needs numpy: pip install numpy", done.stderr)

    def test_says_what_the_tool_says(self):
        for path, settings, text, code in (("nowhere.glb", {}, "^nowhere.glb: ", 3),
                                           (DOLL_MESH, {"penetration_depth": 7}, "penetration_depth", 3)):
            with self.assertRaisesRegex(spherechain.ToolError, text) as caught:
                spherechain.bake(path, tool=TOOL, **settings)
            self.assertEqual(caught.exception.code, code)


if __name__ == "__main__":
    unittest.main()
