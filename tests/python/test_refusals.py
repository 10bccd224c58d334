# SPDX-License-Identifier: MIT
"""Bad input: an exception that says what is wrong, and what to pass."""

import _thread
import re
import signal
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np
import spherechain
from spherechain import _native

from palettes import heap, rest_pose, rotations
from paths import DOLL, PAPER_DOLL


class Refusals(unittest.TestCase):
    def setUp(self):
        self.asset = spherechain.Asset(DOLL)
        self.rest = rest_pose(self.asset)

    def refuses(self, error, text, function, *arguments, **options):
        with self.assertRaisesRegex(error, text):
            function(*arguments, **options)

    def test_files(self):
        data = DOLL.read_bytes()
        self.refuses(FileNotFoundError, "nowhere.sphc", spherechain.Asset, "nowhere.sphc")
        self.refuses(TypeError, "a path or bytes, not int", spherechain.Asset, 5)
        with tempfile.TemporaryDirectory() as folder:
            for name, content, text in (("short.sphc", data[:5000], "short.sphc: "), ("empty.sphc", b"", "empty.sphc: "),
                                        ("text.sphc", b"hello" * 99, "text.sphc: ")):
                Path(folder, name).write_bytes(content)
                self.refuses(ValueError, text, spherechain.Asset, Path(folder, name))
        self.refuses(ValueError, "asset: ", spherechain.Asset, data[1:])

    def test_poses(self):
        every = (self.asset.spheres, self.asset.pairs, self.asset.contacts, self.asset.sphere_energy,
                 self.asset.skin_energy)
        broken = self.rest.copy()
        broken[3, 1, 2] = np.nan
        endless = np.stack([self.rest, broken])
        endless[1, 3, 1, 2] = np.inf
        for function in every:
            self.refuses(TypeError, r"bones is int64: pass float32", function, self.rest.astype(np.int64))
            self.refuses(TypeError, "bones is object|bones is <U", function, "bones")
            self.refuses(TypeError, "bones is object", function, [None])
            self.refuses(ValueError, rf"bones has the shape .*: pass \(..., {len(self.asset.bones)}, 3, 4\)", function,
                         self.rest[1:])
            self.refuses(ValueError, "shape", function, self.rest[..., :3])
            self.refuses(ValueError, "shape", function, self.rest[0])
            self.refuses(ValueError, r"bones\[3, 1, 2\] is nan", function, broken)
            self.refuses(ValueError, r"bones\[1, 3, 1, 2\] is inf", function, endless)
            for threads in (-1, 1.5, True, 5000):
                self.refuses(ValueError, "threads is", function, self.rest, threads=threads)
        self.refuses(TypeError, r"astype\(float32\)", self.asset.spheres, self.rest.astype(np.float64))
        far = self.rest.copy()
        far[0, 0, 3] = 1e30  # its spheres would touch nothing, and lower the energy
        self.refuses(ValueError, r"bones\[0, 0, 3\] is 1", self.asset.sphere_energy, far)
        self.refuses(AttributeError, "height cannot be set", setattr, self.asset, "height", 1)
        self.refuses(ValueError, "radius is 'big': pass one of detect, fit", self.asset.spheres, self.rest, radius="big")

    def test_a_pose_that_is_not_the_bind_pose(self):
        model = np.eye(4, dtype=np.float32)
        model[:3, :3], model[:3, 3] = rotations(np.array([[0.3, 0.9, -0.2]]))[0], (5, 6, 7)
        bones = np.tile(model, (2, len(self.asset.bones), 1, 1))
        self.asset.check_rest(self.rest)
        self.asset.check_rest(bones)
        moved = bones.copy()
        moved[1, 3, 0, 3] += 0.01 * self.asset.height
        name = re.escape(self.asset.bones[3].name)
        self.refuses(ValueError, f'^bone "{name}": its matrix is not that of .*bind pose', self.asset.check_rest, moved)
        bind = np.stack([bone.inverse_bind for bone in self.asset.bones])  # world matrices, not skinning matrices
        self.refuses(ValueError, '^bone "', self.asset.check_rest, bind)
        self.refuses(ValueError, "transposed", self.asset.check_rest, bones.swapaxes(2, 3))
        self.refuses(ValueError, "bones has the shape", self.asset.check_rest, self.rest[1:])

    def test_an_interrupt_ends_a_batch(self):
        poses = np.repeat(heap(self.asset)[None], 400, 0)
        handler = signal.signal(signal.SIGINT, signal.default_int_handler)
        self.addCleanup(signal.signal, signal.SIGINT, handler)
        for threads in (1, 2):
            start = time.process_time()
            threading.Timer(0.1, _thread.interrupt_main).start()
            with self.assertRaises(KeyboardInterrupt):
                self.asset.contacts(poses, threads=threads)
            self.assertLess(time.process_time() - start, 5, "seconds of the processor; the batch would take 40")

    def test_contacts(self):
        vertices = np.zeros((self.asset.vertex_count, 3), np.float32)
        self.refuses(TypeError, "one of the two", self.asset.contacts)
        self.refuses(TypeError, "one of the two", self.asset.contacts, self.rest, vertices=vertices)
        self.refuses(ValueError, "vertices has the shape", self.asset.contacts, vertices=vertices[1:])
        self.refuses(ValueError, "no morph targets", self.asset.contacts, self.rest, morph_weights=vertices[0])
        self.refuses(ValueError, "scope is 'near'", self.asset.contacts, self.rest, scope="near")
        self.refuses(ValueError, "kinds is 'bad'", self.asset.skin_energy, self.rest, kinds=["bad"])
        self.refuses(ValueError, "triangles has numbers", self.asset.points, self.rest, [self.asset.triangle_count],
                     np.ones((1, 3), np.float32))
        self.refuses(ValueError, "pass integers", self.asset.points, self.rest, [0.5], np.ones((1, 3), np.float32))
        self.refuses(ValueError, "weights has the shape", self.asset.points, self.rest, [1], np.ones((2, 3), np.float32))

    def test_gradients(self):
        slopes = np.zeros((self.asset.sphere_count, 4), np.float32)
        self.refuses(TypeError, "gradient is float64", self.asset.spheres_vjp, self.rest, slopes.astype(np.float64))
        self.refuses(ValueError, "gradient has the shape", self.asset.spheres_vjp, self.rest, slopes[1:])
        self.refuses(ValueError, "spheres has the shape", self.asset.pair_energy, slopes[1:])

    def test_an_asset_whose_spheres_follow_vertices_alone(self):
        paper = spherechain.Asset(PAPER_DOLL)
        for function in (paper.spheres, paper.sphere_energy):
            self.refuses(ValueError, "pose.bones", function, rest_pose(paper))

    def test_the_module_itself_reads_nothing_out_of_bounds(self):
        native = _native.Asset(DOLL.read_bytes())
        short = np.zeros((2, len(self.asset.bones) - 1, 3, 4), np.float32)
        overlapping = np.lib.stride_tricks.as_strided(self.rest, (1, *self.rest.shape), (0, 4, 16, 4))
        for bones in (short, overlapping, self.rest):
            self.refuses((ValueError, TypeError), "bones|incompatible", native.spheres, bones, 0, 1)
            self.refuses((ValueError, TypeError), "bones|incompatible", native.sphere_energy, bones, 0, 1)
        self.refuses(ValueError, "first", native.depth_gradients, np.zeros(0, np.uint8), np.array([0, 9], np.uint64),
                     np.zeros(0, np.float32), None)
        self.refuses(ValueError, "first", native.depth_gradients, np.zeros(0, np.uint8), np.zeros(0, np.uint64),
                     np.zeros(0, np.float32), None)

    def test_types_name_all_that_the_module_has(self):
        stub = Path(spherechain.__file__).with_name("_native.pyi").read_text()
        names = {name for name in dir(_native.Asset) if not name.startswith("_")}
        self.assertEqual(set(re.findall(r"def (\w+)\(\s*self", stub)) - {"__init__"}, names)


if __name__ == "__main__":
    unittest.main()
