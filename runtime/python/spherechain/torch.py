# SPDX-License-Identifier: MIT
"""The losses for PyTorch. The work is done on the CPU; tensors of other devices are copied there and back."""

from __future__ import annotations

import torch

from ._asset import Asset


class _Loss(torch.autograd.Function):
    @staticmethod
    def forward(ctx, bones, loss):
        energy, gradient = loss(bones.detach().cpu().numpy())
        ctx.save_for_backward(torch.as_tensor(gradient, device=bones.device))
        return torch.as_tensor(energy, device=bones.device)

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx, slopes):
        (gradient,) = ctx.saved_tensors
        return slopes[..., None, None, None] * gradient, None


def sphere_energy(asset: Asset, bones: torch.Tensor, **options) -> torch.Tensor:
    """Asset.sphere_energy() of a float32 or float64 tensor (..., bones, 3, 4): a tensor (...) that has a gradient."""
    return _Loss.apply(bones, lambda array: asset.sphere_energy(array, **options))


def skin_energy(asset: Asset, bones: torch.Tensor, **options) -> torch.Tensor:
    """Asset.skin_energy() of a float32 tensor (..., bones, 3, 4): a tensor (...) that has a gradient."""
    return _Loss.apply(bones, lambda array: asset.skin_energy(array, **options))
