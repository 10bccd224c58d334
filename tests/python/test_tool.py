# SPDX-License-Identifier: MIT
"""bake() and check() with the tool itself, where there is one."""

import os
import shutil
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import spherechain

from paths import DOLL_MESH

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

    def test_says_what_the_tool_says(self):
        for path, settings, text, code in (("nowhere.glb", {}, "^nowhere.glb: ", 3),
                                           (DOLL_MESH, {"penetration_depth": 7}, "penetration_depth", 3)):
            with self.assertRaisesRegex(spherechain.ToolError, text) as caught:
                spherechain.bake(path, tool=TOOL, **settings)
            self.assertEqual(caught.exception.code, code)


if __name__ == "__main__":
    unittest.main()
