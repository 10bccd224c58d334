# SPDX-License-Identifier: MIT
"""The answers are those of the C interface, in whatever form poses come."""

import pickle
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np
import spherechain

from palettes import heap, random_poses, rest_pose
from paths import DOLL, REFERENCE, WRITE_TINY


class Reader:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, dtype, count=None):
        if count is None:
            count = int(self.take(np.uint64, 1)[0])
        out = np.frombuffer(self.data, dtype, count, self.at)
        self.at += out.nbytes
        return out


class Answers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = spherechain.Model(DOLL)
        cls.bones = random_poses(cls.model, 24, 80)
        cls.bones[20] = heap(cls.model)
        cls.all = {"full": True, "classes": spherechain.CLASSES}
        cls.found = cls.model.penetrations(cls.bones, **cls.all)

    def test_are_those_of_the_c_interface_bit_by_bit(self):
        with tempfile.TemporaryDirectory() as folder:
            poses = Path(folder, "bones")
            poses.write_bytes(self.bones.tobytes())
            reader = Reader(subprocess.run([REFERENCE, DOLL, poses], capture_output=True, check=True).stdout)
        spheres, pairs = self.model.spheres(self.bones), self.model.sphere_pairs(self.bones)
        contacts = self.model.contacts(self.bones, full=True, threads=2)
        faults, floor = self.model.penetrations(self.bones), self.model.below((0, 1, 0), 0, self.bones, **self.all)
        firsts = np.broadcast_to(self.bones[0], self.bones.shape)
        with_first = self.model.penetrations(self.bones, other=spherechain.Posed(self.model, firsts), **self.all)
        steps, bounds = self.model.steps(firsts, self.bones), self.model.bounds(self.bones)
        counts = np.zeros(6, int)
        for i, found in enumerate(self.found):
            self.assertEqual(spheres[i].tobytes(), reader.take(np.float32, 4 * self.model.sphere_count).tobytes())
            self.assertEqual(pairs[i].tobytes(), reader.take(np.dtype("u4,u4")).tobytes())
            self.assertEqual(contacts[i].array.tobytes(), reader.take(spherechain.PART_CONTACT).tobytes())
            self.assertEqual(contacts[i].spheres.tobytes(), reader.take(spherechain.SPHERE_PAIR).tobytes())
            self.assertEqual(contacts[i].triangles.tobytes(), reader.take(spherechain.TRIANGLE_PAIR).tobytes())
            lists = (found, faults[i], floor[i], with_first[i])
            for own in lists:
                self.assertEqual(own.array.tobytes(), reader.take(spherechain.PENETRATION).tobytes())
                self.assertEqual(own.total, len(own))
            self.assertEqual(steps[i].array.tobytes(), reader.take(spherechain.STEP).tobytes())
            self.assertEqual(bounds[i].tobytes(), reader.take(np.float32, 6).tobytes())
            counts += [*map(len, lists), len(steps[i]), len(contacts[i])]
        self.assertEqual(reader.at, len(reader.data))
        self.assertTrue((counts > 10).all(), counts)
        self.assertGreater(len(pairs[20]), 256)
        self.assertGreater(len(contacts[20].triangles), 1024)
        self.assertGreater(len(self.found[20]), 32)

    def test_options_choose_among_all_answers(self):
        pose = self.bones[20]
        everything = self.found[20]
        worst = self.model.penetrations(pose, limit=2, **self.all)
        self.assertEqual(worst.array.tobytes(), everything.array[:2].tobytes())
        self.assertEqual(worst.total, len(everything))
        folds = self.model.penetrations(pose, full=True, classes=["fold"])
        self.assertEqual({entry.kind for entry in folds}, {"fold"})
        pairs = [(int(row["part"]), int(row["other"])) for row in everything.array[:2]]
        self.assertEqual(self.model.penetrations(pose, part_pairs=pairs, **self.all).array.tobytes(), worst.array.tobytes())
        strict = self.model.penetrations(pose, rule=spherechain.Rule(touch_depth=1e-9))
        self.assertGreater(len(strict), len(self.model.penetrations(pose)))
        spheres = self.model.contacts(pose, full=True).spheres
        apart = self.model.contacts(pose, ignored_spheres=[(int(a), int(b)) for a, b in spheres if a != b])
        self.assertLess(len(apart), len(everything))
        nothing = self.model.contacts(pose, other=spherechain.Posed(self.model, pose), ignored_parts=range(len(self.model.parts)))
        self.assertEqual(len(nothing), 0)
        part, _, sphere = self.model.triangle(0)
        self.assertTrue(part < len(self.model.parts) and sphere < self.model.sphere_count)

    def test_joints_of_an_engine_come_in_its_order(self):
        order = np.random.default_rng(5).permutation(len(self.model.bones))
        joints = [*(tuple(self.model.bones[i]) for i in order), ("prop", None)]
        bound = pickle.loads(pickle.dumps(spherechain.Model(DOLL, joints)))
        self.assertEqual(bound.joints, tuple(name for name, _ in joints))
        palette = np.concatenate([self.bones[:, order], self.bones[:, :1]], 1)
        bound.check_rest(rest_pose(self.model)[[*order, 0]])
        for own, other in zip(bound.penetrations(palette), self.model.penetrations(self.bones)):
            self.assertEqual([entry.part for entry in own], [entry.part for entry in other])
            for entry, expected in zip(own, other):
                self.assertEqual(bound.joints[entry.joint], self.model.joints[expected.joint])
                np.testing.assert_array_equal(entry.direction, expected.direction)
        for part, expected in zip(bound.parts, self.model.parts):
            self.assertEqual(bound.joints[part.joint], self.model.joints[expected.joint])
        np.testing.assert_array_equal(bound.spheres(palette), self.model.spheres(self.bones))
        for name in ("sphere_energy", "skin_energy"):
            energy, gradient = getattr(bound, name)(palette)
            expected, slopes = getattr(self.model, name)(self.bones)
            np.testing.assert_array_equal(energy, expected)
            np.testing.assert_array_equal(gradient[:, :-1], slopes[:, order])
            np.testing.assert_array_equal(gradient[:, -1], 0)

    def test_a_direction_of_the_frame_before_is_kept_where_it_is_nearly_as_short(self):
        pose = self.bones[20]
        found = self.model.penetrations(pose)
        turned = found.array.copy()
        turned["direction"] = (0, 0, 1)
        kept = self.model.penetrations(pose, previous=spherechain.Penetrations(turned, found._names, found.total, 1))
        self.assertTrue((kept.array["distance"] > found.array["depth"]).any())
        np.testing.assert_array_equal(kept.array["depth"], found.array["depth"])
        self.assertEqual(self.model.penetrations(pose, previous=found).array.tobytes(), found.array.tobytes())
        with self.assertRaisesRegex(ValueError, "previous: of one pose"):
            self.model.penetrations(self.bones, previous=found)

    def test_do_not_depend_on_threads_shape_or_strides(self):
        wide = np.zeros((4, 6, len(self.model.bones), 4, 4), np.float32)
        wide[..., :3, :] = self.bones.reshape(4, 6, -1, 3, 4)
        backwards = np.flip(np.flip(self.bones, 0).copy(), 0)
        for bones, threads in ((self.bones, 2), (wide, 0), (backwards, 1), (np.asfortranarray(self.bones), 3)):
            np.testing.assert_array_equal(self.model.spheres(bones, threads=threads).reshape(24, -1, 4),
                                          self.model.spheres(self.bones))
            found = self.model.penetrations(bones, threads=threads, **self.all)
            if bones is wide:
                found = [entry for row in found for entry in row]
            self.assertEqual([c.array.tobytes() for c in found], [c.array.tobytes() for c in self.found])
        one = self.model.penetrations(self.bones[3], **self.all)
        self.assertEqual(one.array.tobytes(), self.found[3].array.tobytes())
        self.assertEqual(self.model.penetrations(self.bones[:0]), [])
        self.assertEqual(self.model.spheres(wide[:0]).shape, (0, 6, self.model.sphere_count, 4))

    def test_are_the_same_in_threads_of_python_at_once(self):
        results = [None] * 4

        def run(k):
            results[k] = [c.array.tobytes() for c in fresh.penetrations(self.bones, threads=2, **self.all)]

        fresh = pickle.loads(pickle.dumps(self.model))  # its bodies are made in these threads
        threads = [threading.Thread(target=run, args=(k,)) for k in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(results, [[c.array.tobytes() for c in self.found]] * 4)

    def test_leave_python_free_in_the_meantime(self):
        bones = np.tile(self.bones, (8, 1, 1, 1))
        worker = threading.Thread(target=self.model.penetrations, args=(bones,), kwargs=self.all)
        worker.start()
        turns = 0
        while worker.is_alive():
            time.sleep(0.001)
            turns += 1
        self.assertGreater(turns, 10)

    def test_vertices_give_the_contacts_that_bones_give(self):
        # The doll's vertices are the corners of its triangles, one after another.
        numbers = np.repeat(np.arange(self.model.triangle_count), 3)
        vertices = self.model.points(self.bones, numbers, np.tile(np.eye(3, dtype=np.float32), (len(numbers) // 3, 1)))
        for own, other in zip(self.model.penetrations(vertices=vertices, threads=0, **self.all), self.found):
            own, other = (np.sort(found.array, order=["part", "other"]) for found in (own, other))
            np.testing.assert_array_equal(own[["part", "other", "kind"]], other[["part", "other", "kind"]])
            np.testing.assert_allclose(own["depth"], other["depth"], atol=1e-6 * self.model.height)

    def test_another_body_may_come_as_vertices(self):
        numbers = np.repeat(np.arange(self.model.triangle_count), 3)
        corners = np.tile(np.eye(3, dtype=np.float32), (len(numbers) // 3, 1))
        vertices = self.model.points(self.bones[:4], numbers, corners)
        found = [self.model.contacts(self.bones[4:8], other=other) for other in (
            spherechain.Posed(self.model, self.bones[:4]), spherechain.Posed(self.model, vertices=vertices))]
        self.assertGreater(sum(map(len, found[0])), 10)
        self.assertEqual(*([[entry[:2] for entry in pose] for pose in found] for found in found))

    def test_deepest_points_are_points_on_the_skin(self):
        for bones, contacts in zip(self.bones, self.found):
            for point in (contacts.array["deepest"], contacts.array["deepest_other"]):
                places = self.model.points(bones, point["triangle"], point["weights"])
                np.testing.assert_allclose(places, point["position"], atol=1e-6 * self.model.height)

    def test_morph_weights_move_skin_and_points_alike(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "tiny.sphc")
            subprocess.run([WRITE_TINY, file], check=True)
            tiny = spherechain.Model(file)
        self.assertEqual(len(tiny.morphs), 3)
        bones = random_poses(tiny, 5, 40)
        weights = np.random.default_rng(3).random((5, 3)).astype(np.float32)
        found = tiny.penetrations(bones, morph_weights=weights, threads=2, **self.all)
        self.assertNotEqual([c.array.tobytes() for c in found], [c.array.tobytes() for c in tiny.penetrations(bones, **self.all)])
        for pose, own, contacts in zip(bones, weights, found):
            self.assertGreater(len(contacts), 0)
            ends = [contacts.array[name] for name in ("deepest", "deepest_other")]
            a, b = (tiny.points(pose, end["triangle"], end["weights"], morph_weights=own) for end in ends)
            np.testing.assert_allclose(a, ends[0]["position"], atol=1e-5 * tiny.height)
            np.testing.assert_allclose(b, ends[1]["position"], atol=1e-5 * tiny.height)
            # A depth is linear in the matrices while its points and its direction stay: its slope by them is itself.
            slopes = np.einsum("cbij,bij->c", tiny.depth_gradients(contacts, own), pose)
            np.testing.assert_allclose(slopes, contacts.array["depth"], atol=1e-4 * tiny.height)

    def test_penetrations_have_names_and_units(self):
        names = {part.name for part in self.model.parts}
        for contacts in self.found:
            for contact, row in zip(contacts, contacts.array):
                self.assertLessEqual({contact.part, contact.other}, names)
                self.assertAlmostEqual(contact.depth_mm, row["depth"] * self.model.metres_per_unit * 1000, 3)
                self.assertEqual(contact.is_fault, contact.kind in ("inside", "penetration", "deep_fold"))
                self.assertAlmostEqual(contact.depth_percent, 100 * contact.depth / row["height"], 4)
                self.assertEqual((contact.swallowed, contact.through), (row["swallowed"], row["through"] == 1))
                is_inside = contact.swallowed >= spherechain.Rule().inside
                self.assertTrue(contact.kind == "inside" or not is_inside)
                self.assertTrue(contact.kind != "inside" or is_inside or contact.through)
                np.testing.assert_allclose(contact.point_other - contact.point, contact.distance * contact.direction,
                                           atol=1e-6 * self.model.height)
                if not 0.75 <= contact.swallowed / spherechain.Rule().inside < 1:  # between two ways out
                    self.assertEqual(contact.distance, contact.depth)  # no frame before keeps a longer way
                self.assertTrue((contact.low <= contact.high).all())
                self.assertEqual(contact.volume is None, row["volume"] < 0)
            deepest = max((c.depth_mm for c in contacts if c.is_fault), default=0)
            self.assertAlmostEqual(contacts.depth_mm, deepest, 3)

    def test_at_rest_spheres_are_the_assets_and_nothing_touches(self):
        rest = rest_pose(self.model)
        np.testing.assert_allclose(self.model.spheres(rest), self.model.rest_spheres, atol=1e-6 * self.model.height)
        self.assertEqual(self.model.sphere_pairs(rest).shape, (0, 2))
        self.assertEqual(len(self.model.contacts(rest)), 0)
        self.assertEqual(len(self.model.penetrations(rest, **self.all)), 0)


if __name__ == "__main__":
    unittest.main()
