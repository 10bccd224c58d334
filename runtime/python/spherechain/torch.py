# SPDX-License-Identifier: MIT
"""The losses for PyTorch. The work is done on the CPU; tensors of other devices are copied there and back."""

from __future__ import annotations

import torch

from ._model import Model


class _Loss(torch.autograd.Function):
    @staticmethod
    def forward(ctx, bones, loss):
        energy, gradient = loss(bones.detach().cpu())
        ctx.save_for_backward(bones, torch.as_tensor(gradient, device=bones.device))
        return torch.as_tensor(energy, device=bones.device)

    @staticmethod
    def backward(ctx, slopes):
        bones, gradient = ctx.saved_tensors
        return _Gradient.apply(bones, slopes, gradient), None


class _Gradient(torch.autograd.Function):
    """The loss' gradient. It depends on the bones, but its own gradient is not known: taking it for 0 would be wrong."""

    @staticmethod
    def forward(ctx, bones, slopes, gradient):
        return slopes[..., None, None, None] * gradient

    @staticmethod
    def backward(ctx, slopes):
        raise RuntimeError("spherechain.torch: a loss has no second derivative")


def sphere_energy(model: Model, bones: torch.Tensor, **options) -> torch.Tensor:
    """Model.sphere_energy() of a float32 or float64 tensor (..., bones, 3, 4): a tensor (...) that has a gradient."""
    return _Loss.apply(bones, lambda array: model.sphere_energy(array, **options))


def skin_energy(model: Model, bones: torch.Tensor, **options) -> torch.Tensor:
    """Model.skin_energy() of a float32 tensor (..., bones, 3, 4): a tensor (...) that has a gradient."""
    return _Loss.apply(bones, lambda array: model.skin_energy(array, **options))
