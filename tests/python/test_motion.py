# SPDX-License-Identifier: MIT
"""Motions as palettes, and tables of what is found in them, beside the tool's own answers."""

import json
import os
import shutil
import signal
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np
import spherechain
from spherechain import _process

from palettes import random_poses
from paths import DOLL, DOLL_MESH

TOOL = os.environ.get("SPHERECHAIN_TOOL") or shutil.which("spherechain")
WALK = Path("/usr/share/assimp/models/BVH/01_01.bvh")


class Tables(unittest.TestCase):
    def test_have_a_row_for_each_penetration_and_frame(self):
        model, steps = spherechain.Model(DOLL), []
        poses = random_poses(model, 70, 80)
        table = model.table(poses, classes=spherechain.CLASSES, progress=lambda done, total: steps.append((done, total)))
        found = model.penetrations(poses, classes=spherechain.CLASSES)
        expected = [(i, p.part, p.other, p.kind, p.is_fault, p.depth_mm, p.direction[2], model.joints[p.joint], p.through)
                    for i, pose in enumerate(found) for p in pose]
        columns = "frame part other kind is_fault depth_mm direction_z joint through".split()
        self.assertEqual(list(zip(*(table[name].tolist() for name in columns))), expected)
        self.assertGreater(len(expected), 100)
        self.assertEqual(steps, [(64, 70), (70, 70)])
        contacts = model.table(poses, contacts=True)
        self.assertEqual(contacts["triangle_pairs"].sum(), sum(c.triangle_pairs for pose in model.contacts(poses) for c in pose))
        for name, value in (("classes", spherechain.CLASSES), ("full", True), ("limit", 1), ("nothing", 0)):
            with self.assertRaisesRegex(TypeError, f"^{name} is no option of a table of contacts: scope,"):
                model.table(poses, contacts=True, **{name: value})

    def test_are_of_two_bodies_pose_by_pose(self):
        model = spherechain.Model(DOLL)
        poses, others = random_poses(model, 70, 80), random_poses(model, 71, 40)
        table = model.table(poses, contacts=True, other=spherechain.Posed(model, others[:70]))
        found = model.contacts(poses, other=spherechain.Posed(model, others[:70]))
        self.assertEqual(list(zip(*(table[name].tolist() for name in ("frame", "part", "other")))),
                         [(i, *entry[:2]) for i, pose in enumerate(found) for entry in pose])
        with self.assertRaisesRegex(ValueError, "other has poses"):
            model.table(poses, contacts=True, other=spherechain.Posed(model, others))

    def test_without_a_row_have_all_columns_with_their_types(self):
        model = spherechain.Model(DOLL)
        some, none = (model.table(random_poses(model, count, 80)) for count in (9, 0))
        self.assertEqual([(name, column.dtype.kind) for name, column in some.items()],
                         [(name, column.dtype.kind) for name, column in none.items()])
        self.assertEqual({len(column) for column in none.values()}, {0})


@unittest.skipUnless(TOOL, "skipped: the tool is missing (SPHERECHAIN_TOOL)")
class Motions(unittest.TestCase):
    def play(self, *more):
        subprocess.run([TOOL, "play", DOLL, "--source", DOLL_MESH, *more], check=True, capture_output=True)

    @unittest.skipUnless(WALK.exists(), "skipped: 01_01.bvh is missing (Debian: assimp-testmodels)")
    def test_give_the_faults_that_play_finds(self):
        with tempfile.TemporaryDirectory() as folder:
            result = Path(folder, "play.json")
            self.play("--motion", WALK, "--fps", "1", "--json", result)
            frames = json.loads(result.read_text())["frames"]
        expected = {(frame["clip_frame"], *entry["parts"], entry["class"], round(entry["depth_mm"], 3))
                    for frame in frames for entry in frame["penetrations"] if entry["class"] in spherechain.FAULTS}
        motion = spherechain.load_motion(DOLL, WALK, fps=1, tool=TOOL)  # the source lies beside the asset
        table = spherechain.Model(DOLL).table(motion)
        self.assertEqual(set(zip(table["frame"].tolist(), *(table[name].tolist() for name in ("part", "other", "kind")),
                                 table["depth_mm"].round(3).tolist())), expected)
        self.assertGreater(len(expected), 10)
        self.assertEqual((motion.fps, motion.clips), (1, ("01_01.bvh",)))
        np.testing.assert_allclose(table["time"], table["frame"])

    @unittest.skipUnless(WALK.exists(), "skipped: 01_01.bvh is missing (Debian: assimp-testmodels)")
    def test_that_the_tool_wrote_are_read_in_the_order_of_an_engine(self):
        model = spherechain.Model(DOLL)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "palettes.npz")
            self.play("--motion", WALK, "--frames", "3", "--palettes", file)
            plain = spherechain.load_motion(model, file, tool="/nowhere")
            turned = spherechain.load_motion(spherechain.Model(DOLL, model.joints[::-1] + ("prop",)), file)
            np.testing.assert_array_equal(turned.palettes[:, -2::-1], plain.palettes)
            tables = dict(np.load(file))
            np.savez(file, **{**tables, "clips": ["Walk", "Run"], "fps": [30.0, 60.0], "clip": [0, 0, 1]})
            run = spherechain.load_motion(model, file, "Run")
            np.testing.assert_array_equal(run.palettes, plain.palettes[2:])
            self.assertEqual((run.clips, run.fps, run.clip.tolist()), (("Run",), 60, [0]))
            with self.assertRaisesRegex(ValueError, "has no clip 'Jump': it has Walk, Run"):
                spherechain.load_motion(model, file, "Jump")
            for name, text in (("joints", "are not the bones"), ("inverse_bind", "of another character")):
                np.savez(file, **{**tables, name: tables[name][::-1]})
                with self.assertRaisesRegex(ValueError, text):
                    spherechain.load_motion(model, file)
        self.assertIn("row", str(tables["layout"]))

    def test_end_at_once_with_an_interrupt(self):
        handler = signal.signal(signal.SIGINT, signal.default_int_handler)
        self.addCleanup(signal.signal, signal.SIGINT, handler)
        processes, times = [], []

        def interrupt(process):
            processes.append(process)
            threading.Timer(0.2, lambda: (times.append(time.monotonic()), os.kill(os.getpid(), signal.SIGINT))).start()

        with tempfile.TemporaryDirectory() as folder:
            pipe = Path(folder, "asset.sphc")
            os.mkfifo(pipe)  # the tool waits for an asset that nobody writes
            with self.assertRaises(KeyboardInterrupt):
                _process.run_tool(["inspect", os.fspath(pipe)], TOOL, started=interrupt)
        self.assertLess(time.monotonic() - times[0], 1)  # 0.3 on a machine that does nothing else
        self.assertIsNotNone(processes[0].returncode)


if __name__ == "__main__":
    unittest.main()
