# SPDX-License-Identifier: MIT
"""The losses for PyTorch, where it is there."""

import unittest

import numpy as np
import spherechain

from palettes import random_poses
from paths import DOLL

try:
    import torch
except ImportError:
    torch = None


@unittest.skipIf(torch is None, "skipped: torch is missing (Debian: python3-torch)")
class Torch(unittest.TestCase):
    def test_has_the_gradients_of_the_asset(self):
        import spherechain.torch

        model = spherechain.Model(DOLL)
        poses = random_poses(model, 12, 80, dtype=np.float64)
        bones = torch.from_numpy(poses).requires_grad_()
        weights = torch.arange(12, dtype=torch.float64)
        energy = spherechain.torch.sphere_energy(model, bones)
        self.assertEqual((energy.dtype, energy.shape), (torch.float64, (12,)))
        (energy * weights).sum().backward()
        expected = model.sphere_energy(poses)[1] * weights.numpy()[:, None, None, None]
        np.testing.assert_allclose(bones.grad.numpy(), expected)
        self.assertTrue(torch.autograd.gradcheck(lambda b: spherechain.torch.sphere_energy(model, b), bones[1:2]))

        single = poses.astype(np.float32)[1]
        one = torch.from_numpy(single).requires_grad_()
        energy = spherechain.torch.skin_energy(model, one)
        self.assertEqual((energy.dtype, energy.shape), (torch.float32, ()))
        energy.backward()
        np.testing.assert_allclose(one.grad.numpy(), model.skin_energy(single)[1])

    def test_has_no_second_derivative_and_says_so(self):
        import spherechain.torch

        model = spherechain.Model(DOLL)
        bones = torch.from_numpy(random_poses(model, 3, 80)).requires_grad_()
        for loss in (spherechain.torch.sphere_energy, spherechain.torch.skin_energy):
            slopes, = torch.autograd.grad(loss(model, bones).sum(), bones, create_graph=True)
            with self.assertRaisesRegex(RuntimeError, "no second derivative"):
                torch.autograd.grad(slopes.square().sum(), bones)

    def test_refuses_what_the_asset_refuses(self):
        import spherechain.torch

        model = spherechain.Model(DOLL)
        bones = torch.from_numpy(random_poses(model, 1, 80))
        with self.assertRaisesRegex(TypeError, r"bones is float64: .*bones\.to\(torch\.float32\)"):
            spherechain.torch.skin_energy(model, bones.double())
        bones[0, 2, 1, 3] = 1e30
        with self.assertRaisesRegex(ValueError, r"bones\[0, 2, 1, 3\] is 1"):
            spherechain.torch.sphere_energy(model, bones)


if __name__ == "__main__":
    unittest.main()
