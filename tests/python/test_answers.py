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
        cls.asset = spherechain.Asset(DOLL)
        cls.bones = random_poses(cls.asset, 24, 80)
        cls.bones[20] = heap(cls.asset)
        cls.contacts = cls.asset.contacts(cls.bones, triangles=True)

    def test_are_those_of_the_c_interface_bit_by_bit(self):
        with tempfile.TemporaryDirectory() as folder:
            poses = Path(folder, "bones")
            poses.write_bytes(self.bones.tobytes())
            reader = Reader(subprocess.run([REFERENCE, DOLL, poses], capture_output=True, check=True).stdout)
        spheres, pairs = self.asset.spheres(self.bones), self.asset.pairs(self.bones)
        found = 0
        for i, contacts in enumerate(self.contacts):
            self.assertEqual(spheres[i].tobytes(), reader.take(np.float32, 4 * self.asset.sphere_count).tobytes())
            self.assertEqual(pairs[i].tobytes(), reader.take(np.dtype("u4,u4")).tobytes())
            self.assertEqual(contacts.triangles.tobytes(), reader.take(spherechain.TRIANGLE_PAIR).tobytes())
            self.assertEqual(contacts.array.tobytes(), reader.take(spherechain.PENETRATION).tobytes())
            found += len(contacts)
        self.assertEqual(reader.at, len(reader.data))
        self.assertGreater(found, 24)
        self.assertGreater(len(pairs[20]), 256)
        self.assertGreater(len(self.contacts[20].triangles), 1024)
        self.assertGreater(len(self.contacts[20]), 32)

    def test_do_not_depend_on_threads_shape_or_strides(self):
        wide = np.zeros((4, 6, len(self.asset.bones), 4, 4), np.float32)
        wide[..., :3, :] = self.bones.reshape(4, 6, -1, 3, 4)
        backwards = np.flip(np.flip(self.bones, 0).copy(), 0)
        for bones, threads in ((self.bones, 2), (wide, 0), (backwards, 1), (np.asfortranarray(self.bones), 3)):
            np.testing.assert_array_equal(self.asset.spheres(bones, threads=threads).reshape(24, -1, 4),
                                          self.asset.spheres(self.bones))
            contacts = self.asset.contacts(bones, threads=threads)
            if bones is wide:
                contacts = [entry for row in contacts for entry in row]
            self.assertEqual([c.array.tobytes() for c in contacts], [c.array.tobytes() for c in self.contacts])
        one = self.asset.contacts(self.bones[3])
        self.assertEqual(one.array.tobytes(), self.contacts[3].array.tobytes())
        self.assertEqual(self.asset.contacts(self.bones[:0]), [])
        self.assertEqual(self.asset.spheres(wide[:0]).shape, (0, 6, self.asset.sphere_count, 4))

    def test_are_the_same_in_threads_of_python_at_once(self):
        results = [None] * 4

        def run(k):
            results[k] = [c.array.tobytes() for c in spherechain_asset.contacts(self.bones, threads=2)]

        spherechain_asset = pickle.loads(pickle.dumps(self.asset))  # its tables are made in these threads
        threads = [threading.Thread(target=run, args=(k,)) for k in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(results, [[c.array.tobytes() for c in self.contacts]] * 4)

    def test_leave_python_free_in_the_meantime(self):
        bones = np.tile(self.bones, (8, 1, 1, 1))
        worker = threading.Thread(target=self.asset.contacts, args=(bones,))
        worker.start()
        turns = 0
        while worker.is_alive():
            time.sleep(0.001)
            turns += 1
        self.assertGreater(turns, 10)

    def test_vertices_give_the_contacts_that_bones_give(self):
        # The doll's vertices are the corners of its triangles, one after another.
        numbers = np.repeat(np.arange(self.asset.triangle_count), 3)
        vertices = self.asset.points(self.bones, numbers, np.tile(np.eye(3, dtype=np.float32), (len(numbers) // 3, 1)))
        for own, other in zip(self.asset.contacts(vertices=vertices, threads=0), self.contacts):
            np.testing.assert_array_equal(own.array[["part", "other", "kind"]], other.array[["part", "other", "kind"]])
            np.testing.assert_allclose(own.array["depth"], other.array["depth"], atol=1e-6 * self.asset.height)

    def test_deepest_points_are_points_on_the_skin(self):
        for bones, contacts in zip(self.bones, self.contacts):
            for point in (contacts.array["deepest"], contacts.array["deepest_other"]):
                places = self.asset.points(bones, point["triangle"], point["weights"])
                np.testing.assert_allclose(places, point["position"], atol=1e-6 * self.asset.height)

    def test_morph_weights_move_skin_and_points_alike(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "tiny.sphc")
            subprocess.run([WRITE_TINY, file], check=True)
            tiny = spherechain.Asset(file)
        self.assertEqual(len(tiny.morphs), 3)
        bones = random_poses(tiny, 5, 40)
        weights = np.random.default_rng(3).random((5, 3)).astype(np.float32)
        found = tiny.contacts(bones, morph_weights=weights, threads=2)
        self.assertNotEqual([c.array.tobytes() for c in found], [c.array.tobytes() for c in tiny.contacts(bones)])
        for pose, own, contacts in zip(bones, weights, found):
            self.assertGreater(len(contacts), 0)
            ends = [contacts.array[name] for name in ("deepest", "deepest_other")]
            a, b = (tiny.points(pose, end["triangle"], end["weights"], morph_weights=own) for end in ends)
            np.testing.assert_allclose(a, ends[0]["position"], atol=1e-5 * tiny.height)
            np.testing.assert_allclose(b, ends[1]["position"], atol=1e-5 * tiny.height)
            # A depth is linear in the matrices while its points and its direction stay: its slope by them is itself.
            slopes = np.einsum("cbij,bij->c", tiny.depth_gradients(contacts, own), pose)
            np.testing.assert_allclose(slopes, contacts.array["depth"], atol=1e-4 * tiny.height)

    def test_contacts_have_names_and_units(self):
        names = {part.name for part in self.asset.parts}
        for contacts in self.contacts:
            for contact, row in zip(contacts, contacts.array):
                self.assertLessEqual({contact.part, contact.other}, names)
                self.assertAlmostEqual(contact.depth_mm, row["depth"] * self.asset.metres_per_unit * 1000, 3)
                self.assertEqual(contact.is_fault, contact.kind in ("penetration", "deep_fold"))
                np.testing.assert_allclose(contact.point_other - contact.point, contact.distance * contact.direction,
                                           atol=1e-6 * self.asset.height)
                self.assertEqual(contact.distance, contact.depth)  # no frame before keeps a longer way
                self.assertTrue((contact.low <= contact.high).all())
                self.assertEqual(contact.volume is None, row["volume"] < 0)
            deepest = max((c.depth_mm for c in contacts if c.is_fault), default=0)
            self.assertAlmostEqual(contacts.depth_mm, deepest, 3)

    def test_at_rest_spheres_are_the_assets_and_nothing_touches(self):
        rest = rest_pose(self.asset)
        np.testing.assert_allclose(self.asset.spheres(rest), self.asset.rest_spheres, atol=1e-6 * self.asset.height)
        self.assertEqual(self.asset.pairs(rest).shape, (0, 2))
        self.assertEqual(len(self.asset.contacts(rest)), 0)


if __name__ == "__main__":
    unittest.main()
