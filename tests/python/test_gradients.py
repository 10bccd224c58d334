# SPDX-License-Identifier: MIT
"""Losses and their gradients: finite differences, and what a loss must do."""

import unittest

import numpy as np
import spherechain

from palettes import random_poses, rest_pose
from paths import DOLL


def slope_along(function, at, direction, step=1e-6):
    return (function(at + step * direction) - function(at - step * direction)) / (2 * step)


def assert_near(actual, expected, tolerance):
    """As part of the greatest figure."""
    np.testing.assert_allclose(actual, expected, rtol=0, atol=tolerance * np.abs(expected).max())


class Gradients(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = spherechain.Model(DOLL)
        cls.bones = random_poses(cls.model, 12, 80, dtype=np.float64)
        cls.single = cls.bones.astype(np.float32)
        cls.rng = np.random.default_rng(7)

    def assert_is_slope(self, gradient, function, at):
        for _ in range(4):
            direction = self.rng.normal(size=at.shape)
            axes = tuple(range(1, at.ndim))
            expected = slope_along(function, at, direction)
            own = (gradient * direction).sum(axes)
            assert_near(own, expected, 1e-4)

    def test_of_the_spheres_energy_is_its_slope(self):
        for radius in ("detect", "fit"):
            energy, gradient = self.model.sphere_energy(self.bones, radius=radius)
            self.assertGreater((energy > 0).sum(), 6)
            self.assert_is_slope(gradient, lambda bones: self.model.sphere_energy(bones, radius=radius)[0], self.bones)

    def test_of_given_spheres_is_its_slope(self):
        spheres = self.model.spheres(self.single).astype(np.float64)
        _, gradient = self.model.pair_energy(spheres)
        self.assert_is_slope(gradient, lambda s: self.model.pair_energy(s)[0], spheres)

    def test_in_single_precision_is_that_in_double(self):
        for own, exact in zip(self.model.sphere_energy(self.single, threads=2), self.model.sphere_energy(self.bones)):
            self.assertEqual(own.dtype, np.float32)
            assert_near(own, exact, 1e-5)

    def test_a_loss_of_ones_own_gets_its_gradient_through_the_spheres(self):
        loss_slopes = self.rng.normal(size=(12, self.model.sphere_count, 4))
        gradient = self.model.spheres_vjp(self.bones, loss_slopes)
        single = self.model.spheres_vjp(self.single, loss_slopes.astype(np.float32))
        assert_near(single, gradient, 1e-5)
        # Spheres come in single precision, so steps are large; centres are linear in the matrices, radii nearly.
        for _ in range(4):
            direction = self.rng.normal(size=self.bones.shape) / 10
            ends = [self.model.spheres((self.bones + sign * 0.01 * direction).astype(np.float32)) for sign in (1, -1)]
            expected = ((ends[0].astype(float) - ends[1]) * loss_slopes).sum((1, 2)) / 0.02
            assert_near((gradient * direction).sum((1, 2, 3)), expected, 1e-3)

    def test_the_energy_is_the_sum_of_squared_overlaps_and_above_zero_where_spheres_touch(self):
        spheres = self.model.spheres(self.single).astype(np.float64)
        distances = np.linalg.norm(spheres[:, :, None, :3] - spheres[:, None, :, :3], axis=3)
        reach = self.model.pair_scales() * (spheres[:, :, None, 3] + spheres[:, None, :, 3])
        expected = np.square(np.maximum(reach - distances, 0)).sum((1, 2)) / 2
        energy, gradient = self.model.sphere_energy(self.single)
        np.testing.assert_allclose(energy, expected, rtol=1e-4, atol=1e-9)
        np.testing.assert_array_equal(energy > 0, [len(pairs) > 0 for pairs in self.model.sphere_pairs(self.single)])
        np.testing.assert_array_equal(gradient[energy == 0], 0)
        self.assertEqual(self.model.sphere_energy(rest_pose(self.model))[0], 0)

    def test_of_a_depth_is_the_slope_of_the_deepest_points_distance(self):
        seen = 0
        every = self.model.penetrations(self.single, full=True, classes=spherechain.CLASSES)
        for bones, contacts in zip(self.bones, every):
            if len(contacts) == 0:
                continue
            a, b = contacts.array["deepest"], contacts.array["deepest_other"]

            def distances(at):
                ends = [self.model.points(at, p["triangle"], p["weights"].copy()) for p in (a, b)]
                return np.linalg.norm(ends[0] - ends[1], axis=-1)

            gradients = self.model.depth_gradients(contacts)
            direction = self.rng.normal(size=bones.shape)
            expected = slope_along(distances, bones, direction, 1e-7)
            # The points are in single precision: where a contact is shallow, they give the direction to few digits.
            deep = contacts.array["depth"] > 0.01 * self.model.height
            if deep.any():
                assert_near((gradients * direction).sum((1, 2, 3))[deep], expected[deep], 1e-4)
            seen += deep.sum()
        self.assertGreater(seen, 12)

    def test_a_step_down_lowers_both_energies(self):
        for energy_of in (self.model.sphere_energy, self.model.skin_energy):
            energy, gradient = energy_of(self.single)
            used = energy > 0
            self.assertGreater(used.sum(), 4)
            squares = np.square(gradient).sum((1, 2, 3))
            step = np.where(used, 0.1 * energy / np.where(used, squares, 1), 0).astype(np.float32)
            after, _ = energy_of(self.single - step[:, None, None, None] * gradient)
            # Where nothing else gets in the way, a tenth less.
            self.assertLess(abs(np.median(after[used] / energy[used]) - 0.9), 0.02)

    def test_the_skins_energy_is_the_sum_of_squared_depths_beyond_the_rule_or_of_its_kinds(self):
        contacts = self.model.penetrations(self.single, full=True, classes=spherechain.CLASSES)
        for kinds in (None, ("penetration", "deep_fold"), ("touch", "fold")):
            classes = {} if kinds is None else {"classes": kinds}
            energy, gradient = self.model.skin_energy(self.single, full=True, threads=2, **classes)
            for i, found in enumerate(contacts):
                depths = np.array([c.fault_depth if kinds is None else c.depth if c.kind in kinds else 0 for c in found],
                                  np.float32)
                self.assertAlmostEqual(energy[i], np.square(depths).sum(), delta=1e-5 * energy.max())
                expected = np.tensordot(2 * depths, self.model.depth_gradients(found), 1)
                np.testing.assert_allclose(gradient[i], expected, rtol=1e-5, atol=1e-6 * np.abs(gradient).max())


if __name__ == "__main__":
    unittest.main()
