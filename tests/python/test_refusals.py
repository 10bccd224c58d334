# SPDX-License-Identifier: MIT
"""Bad input: an exception that says what is wrong, and what to pass."""

import _thread
import re
import signal
import tempfile
import threading
import time
import unittest
import warnings
from pathlib import Path

import numpy as np
import spherechain
from spherechain import _native

from palettes import heap, random_poses, rest_pose, rotations
from paths import DOLL, PAPER_DOLL


class Refusals(unittest.TestCase):
    def setUp(self):
        self.model = spherechain.Model(DOLL)
        self.rest = rest_pose(self.model)

    def refuses(self, error, text, function, *arguments, **options):
        with self.assertRaisesRegex(error, text):
            function(*arguments, **options)

    def test_files(self):
        data = DOLL.read_bytes()
        self.refuses(FileNotFoundError, "nowhere.sphc", spherechain.Model, "nowhere.sphc")
        self.refuses(TypeError, "a path or bytes, not int", spherechain.Model, 5)
        with tempfile.TemporaryDirectory() as folder:
            for name, content, text in (("short.sphc", data[:5000], "short.sphc: "), ("empty.sphc", b"", "empty.sphc: "),
                                        ("text.sphc", b"hello" * 99, "text.sphc: ")):
                Path(folder, name).write_bytes(content)
                self.refuses(ValueError, text, spherechain.Model, Path(folder, name))
        self.refuses(ValueError, "asset: ", spherechain.Model, data[1:])

    def test_joints(self):
        names = self.model.joints
        self.refuses(ValueError, f'doll.sphc: .*"{names[3]}"', spherechain.Model, DOLL, names[:3] + names[4:])
        other = [(bone.name, bone.inverse_bind + (i == 3)) for i, bone in enumerate(self.model.bones)]
        self.refuses(ValueError, f'"{names[3]}"', spherechain.Model, DOLL, other)
        self.refuses(ValueError, "joints: another shape", spherechain.Model, DOLL, [(names[0], np.eye(2))])

    def test_poses(self):
        every = (self.model.spheres, self.model.sphere_pairs, self.model.contacts, self.model.penetrations,
                 self.model.bounds, self.model.sphere_energy, self.model.skin_energy)
        broken = self.rest.copy()
        broken[3, 1, 2] = np.nan
        endless = np.stack([self.rest, broken])
        endless[1, 3, 1, 2] = np.inf
        for function in every:
            self.refuses(TypeError, r"bones is int64: pass float32", function, self.rest.astype(np.int64))
            self.refuses(TypeError, "bones is object|bones is <U", function, "bones")
            self.refuses(TypeError, "bones is object", function, [None])
            self.refuses(ValueError, rf"bones has the shape .*: pass \(..., {len(self.model.bones)}, 3, 4\)", function,
                         self.rest[1:])
            self.refuses(ValueError, "shape", function, self.rest[..., :3])
            self.refuses(ValueError, "shape", function, self.rest[0])
            self.refuses(ValueError, r"bones\[3, 1, 2\] is nan", function, broken)
            self.refuses(ValueError, r"bones\[1, 3, 1, 2\] is inf", function, endless)
            for threads in (-1, 1.5, True, 5000):
                self.refuses(ValueError, "threads is", function, self.rest, threads=threads)
        self.refuses(TypeError, r"astype\(float32\)", self.model.spheres, self.rest.astype(np.float64))
        far = self.rest.copy()
        far[0, 0, 3] = 1e30  # its spheres would touch nothing, and lower the energy
        self.refuses(ValueError, r"bones\[0, 0, 3\] is 1", self.model.sphere_energy, far)
        self.refuses(AttributeError, "height cannot be set", setattr, self.model, "height", 1)
        self.refuses(ValueError, "radius is 'big': pass one of detect, fit", self.model.spheres, self.rest, radius="big")

    def test_a_pose_that_is_not_the_bind_pose(self):
        model = np.eye(4, dtype=np.float32)
        model[:3, :3], model[:3, 3] = rotations(np.array([[0.3, 0.9, -0.2]]))[0], (5, 6, 7)
        bones = np.tile(model, (2, len(self.model.bones), 1, 1))
        self.model.check_rest(self.rest)
        self.model.check_rest(bones)
        moved = bones.copy()
        moved[1, 3, 0, 3] += 0.01 * self.model.height
        name = re.escape(self.model.bones[3].name)
        self.refuses(ValueError, f'^bone "{name}": its matrix is not that of .*bind pose', self.model.check_rest, moved)
        bind = np.stack([bone.inverse_bind for bone in self.model.bones])  # world matrices, not skinning matrices
        self.refuses(ValueError, '^bone ".*; they are', self.model.check_rest, np.linalg.inv(
            np.concatenate([bind, np.broadcast_to([[0, 0, 0, 1]], (len(bind), 1, 4))], 1)).astype(np.float32))
        self.refuses(ValueError, "transposed", self.model.check_rest, bones.swapaxes(2, 3))
        self.refuses(ValueError, "bones has the shape", self.model.check_rest, self.rest[1:])

    def test_matrices_that_tear_the_body_in_any_pose(self):
        def whole(matrices):
            return np.concatenate([matrices, np.broadcast_to([[[0, 0, 0, 1]]], (*matrices.shape[:2], 1, 4))], 2)

        poses = whole(random_poses(self.model, 8, 60).astype(float))
        binds = whole(np.stack([bone.inverse_bind for bone in self.model.bones])[None].astype(float))
        world = poses @ np.linalg.inv(binds)
        scaled = np.diag([3, -3, 3, 1]).astype(float)
        scaled[:3, 3] = (5, 6, 7)
        for right in (poses, scaled @ poses, poses[:1], np.tile(scaled, (1, len(self.model.bones), 1, 1))):
            self.model.check_pose(right.astype(np.float32))
        centimetres = poses.copy()
        centimetres[..., :3, 3] *= 100
        for wrong, text in ((world, "they are world matrices"), (world[:1], "they are world matrices"),
                            (poses.swapaxes(2, 3), "transposed"), (poses.swapaxes(2, 3)[:, :, :3], "transposed"),
                            (binds @ world, "on the wrong side"), (centimetres, "in centimetres, and the asset in metres"),
                            (poses[:, ::-1], "another order")):
            with self.subTest(text):
                self.refuses(ValueError, text, self.model.check_pose, wrong.astype(np.float32))
        for ask in (self.model.penetrations, spherechain.Model(DOLL).spheres):
            with self.assertWarnsRegex(spherechain.MatrixWarning, "doll.*they are world matrices") as caught:
                ask(world.astype(np.float32)[:, :, :3])
            self.assertEqual(caught.filename, __file__)
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # it is said once; right poses say nothing
            self.model.penetrations(world.astype(np.float32)[:1])
            spherechain.Model(DOLL).sphere_energy(poses.astype(np.float32))

    def test_an_interrupt_ends_a_batch(self):
        poses = np.repeat(heap(self.model)[None], 400, 0)
        handler = signal.signal(signal.SIGINT, signal.default_int_handler)
        self.addCleanup(signal.signal, signal.SIGINT, handler)
        for threads in (1, 2):
            start = time.process_time()
            threading.Timer(0.1, _thread.interrupt_main).start()
            with self.assertRaises(KeyboardInterrupt):
                self.model.penetrations(poses, threads=threads, full=True, classes=spherechain.CLASSES)
            self.assertLess(time.process_time() - start, 5, "seconds of the processor; the batch would take 40")

    def test_contacts(self):
        vertices = np.zeros((self.model.vertex_count, 3), np.float32)
        self.refuses(TypeError, "one of the two", self.model.contacts)
        self.refuses(TypeError, "one of the two", self.model.contacts, self.rest, vertices=vertices)
        self.refuses(ValueError, "vertices has the shape", self.model.contacts, vertices=vertices[1:])
        self.refuses(ValueError, "no morph targets", self.model.contacts, self.rest, morph_weights=vertices[0])
        self.refuses(ValueError, "scope is 'near'", self.model.contacts, self.rest, scope="near")
        self.refuses(ValueError, "classes is 'bad'", self.model.skin_energy, self.rest, classes=["bad"])
        self.refuses(ValueError, r"classes is \[\]: pass a list", self.model.penetrations, self.rest, classes=[])
        self.refuses(TypeError, "full is 1: pass True or False", self.model.penetrations, self.rest, full=1)
        self.refuses(TypeError, "quick is no option: scope, full", self.model.penetrations, self.rest, quick=True)
        self.refuses(ValueError, "limit is -1", self.model.penetrations, self.rest, limit=-1)
        self.refuses(ValueError, "part_pairs has 0, 99: there are", self.model.contacts, self.rest, part_pairs=[(0, 99)])
        self.refuses(ValueError, "ignored_parts", self.model.contacts, self.rest, ignored_parts=[0])  # of one body
        self.refuses(ValueError, "touch_depth|rule", self.model.penetrations, self.rest,
                     rule=spherechain.Rule(touch_depth=np.nan))
        two = np.stack([self.rest, self.rest])
        self.refuses(ValueError, r"other has poses \(2,\): pass \(\)", self.model.contacts, self.rest,
                     other=spherechain.Posed(self.model, two))
        self.refuses(ValueError, "as many bones_before", self.model.steps, self.rest, self.rest,
                     other=spherechain.Posed(self.model, self.rest))
        self.refuses(ValueError, r"bones_before has poses \(2,\), bones \(\): pass as many", self.model.steps, two, self.rest)
        self.refuses(ValueError, "of length 1", self.model.below, (0, 3, 0), 0, self.rest)
        self.refuses(TypeError, "other is tuple: pass spherechain.Posed", self.model.contacts, self.rest, other=(1, 2))
        self.refuses(TypeError, r"part_pairs is \[3, 7\]: pass a list of pairs", self.model.contacts, self.rest, part_pairs=[3, 7])
        self.refuses(ValueError, "pass a list of names", self.model.penetrations, self.rest, classes="touch")
        self.refuses(ValueError, "triangles has numbers", self.model.points, self.rest, [self.model.triangle_count],
                     np.ones((1, 3), np.float32))
        self.refuses(ValueError, "pass integers", self.model.points, self.rest, [0.5], np.ones((1, 3), np.float32))
        self.refuses(ValueError, "weights has the shape", self.model.points, self.rest, [1], np.ones((2, 3), np.float32))

    def test_gradients(self):
        slopes = np.zeros((self.model.sphere_count, 4), np.float32)
        self.refuses(TypeError, "gradient is float64", self.model.spheres_vjp, self.rest, slopes.astype(np.float64))
        self.refuses(ValueError, "gradient has the shape", self.model.spheres_vjp, self.rest, slopes[1:])
        self.refuses(ValueError, "spheres has the shape", self.model.pair_energy, slopes[1:])

    def test_an_asset_whose_spheres_follow_vertices_alone(self):
        paper = spherechain.Model(PAPER_DOLL)
        for function in (paper.spheres, paper.sphere_energy):
            self.refuses(ValueError, "pose.bones", function, rest_pose(paper))

    def test_the_module_itself_reads_nothing_out_of_bounds(self):
        native = _native.Model(DOLL.read_bytes(), None)
        radius = _native.RADII["detect"]
        short = np.zeros((2, len(self.model.bones) - 1, 3, 4), np.float32)
        overlapping = np.lib.stride_tricks.as_strided(self.rest, (1, *self.rest.shape), (0, 4, 16, 4))
        for bones in (short, overlapping, self.rest):
            self.refuses((ValueError, TypeError), "bones|array of", native.spheres, bones, radius, 1)
        slopes = np.zeros((1, self.model.sphere_count, 4), np.float32)
        self.refuses(ValueError, "gradient", native.spheres_vjp, self.rest[None], slopes[:, 1:], radius, 1)
        self.refuses(ValueError, "spheres", native.pairs, slopes[:, 1:], radius, 1)
        unaligned = np.zeros(slopes.nbytes + 1, np.uint8)[1:].view(np.float32).reshape(slopes.shape)
        for wrong in (slopes.astype(np.float64), slopes.astype(np.int32), slopes.astype(">f4"), unaligned, slopes.tolist()):
            self.refuses(TypeError, "array of", native.pairs, wrong, radius, 1)
        query = self.model._query({}, None, None)

        def ask(question, poses, before=None, other=None, other_poses=None, **options):
            return native.ask(question, (before, poses), other, (None, other_poses), {**query, **options}, 1)

        good = (self.rest[None], None, None)
        for poses in ((short, None, None), (overlapping, None, None), (None, self.rest[None], None), (None, None, None)):
            self.refuses((ValueError, TypeError), "bones|vertices", ask, 0, poses)
        self.refuses(ValueError, "bodies", ask, 2, good)
        self.refuses(ValueError, "before", ask, 2, (np.stack([self.rest] * 2), None, None), good)
        self.refuses(ValueError, "others", ask, 0, good, None, native)
        self.refuses(ValueError, "part_pairs", ask, 0, good, part_pairs=np.zeros(1, np.uint64))
        self.refuses(ValueError, "previous", ask, 0, good, previous=np.zeros(3, np.uint8))
        self.refuses(ValueError, "rule", ask, 0, good, rule=[1.0])
        one, weights = np.zeros(1, np.uint32), np.zeros((1, 3), np.float32)
        self.refuses(ValueError, "rows", native.points_vjp, 1, one + 1, one, weights, weights, None)
        self.refuses(ValueError, "triangle", native.points_vjp, 1, one, one + 10 ** 6, weights, weights, None)
        self.refuses(ValueError, "slopes", native.points_vjp, 1, one, one, weights, weights[:0], None)

    def test_types_name_all_that_the_module_has(self):
        stub = Path(spherechain.__file__).with_name("_native.pyi").read_text()
        names = {name for kind in (_native.Model, _native.Response) for name in dir(kind) if not name.startswith("_")}
        self.assertEqual(set(re.findall(r"    def (\w+)\(", stub)) - {"__init__"}, names)


if __name__ == "__main__":
    unittest.main()
