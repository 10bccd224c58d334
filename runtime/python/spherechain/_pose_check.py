# SPDX-License-Identifier: MIT
"""Which mistake a palette shows: world matrices in place of skinning matrices, transposed ones, and the like.

Where a bone turns in its joint, both the bone and the one that it hangs on take the joint to the same place. Wrong matrices tear
them apart, in any pose. A mistake is named if the palette without it does not tear.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import numpy as np

if TYPE_CHECKING:
    from ._model import Model

_POSES = 16  # evenly spaced, are looked at
# Shares of a bone's length, the median of bones and poses. Right palettes of real characters are below 1e-5, wrong ones above 0.1.
_TORN = 0.1
_TORN_MUCH = 0.25
_JOINTS_MIN = 3
_UNITS = {100: "metres, and the asset in centimetres", 0.01: "centimetres, and the asset in metres",
          1000: "metres, and the asset in millimetres", 0.001: "millimetres, and the asset in metres",
          39.3701: "metres, and the asset in inches", 0.0254: "inches, and the asset in metres"}


def find_mistake(model: "Model", poses: np.ndarray) -> Optional[str]:
    """Says how skinning matrices (poses, joints, 3, 4) in the order of Model.joints are wrong; None: no mistake shows."""
    chosen = np.unique(np.linspace(0, len(poses) - 1, _POSES).astype(int)) if len(poses) else []
    given = model._by_bone(poses[chosen]).astype(np.float64)
    joints = _Joints(model)
    if len(joints.child) < _JOINTS_MIN or not len(given):
        return None
    torn = joints.torn(given)
    if torn < _TORN:
        return None
    binds = np.array([bone.inverse_bind for bone in model.bones], np.float64)

    def is_whole(matrices: np.ndarray) -> bool:
        return joints.torn(matrices) < torn / 20

    if is_whole(_times(given, binds)):
        return "they are world matrices: multiply each by its inverse bind matrix, world @ bone.inverse_bind"
    if not given[..., 3].any():
        return "they are transposed: a translation is the last column, not the last row"
    if is_whole(_times(_inverse(binds), given)) or is_whole(_times(_times(_inverse(binds), given), binds)):
        return "the inverse bind matrix is on the wrong side: pass world @ inverse_bind"
    for scale, text in _UNITS.items():
        if is_whole(np.concatenate([given[..., :3], given[..., 3:] * scale], -1)):
            return f"their translations are in other units: in {text}"
    return None if torn < _TORN_MUCH else "the joints may be in another order than Model.joints, or the rest pose is another"


class _Joints:
    """The joints in which body parts hang on each other."""

    def __init__(self, model: "Model") -> None:
        places = _inverse(np.array([bone.inverse_bind for bone in model.bones], np.float64))[..., 3]
        pairs = {(part.bone, model.parts[part.parent].bone) for part in model.parts if part.parent is not None}
        known = [(child, parent) for child, parent in pairs if child is not None and parent is not None and child != parent
                 and np.linalg.norm(places[child] - places[parent]) > 0.01 * model.height]
        self.child, self.parent = np.array(sorted(known), int).reshape(-1, 2).T
        self.places = places[self.child]
        self.lengths = np.linalg.norm(self.places - places[self.parent], axis=-1)

    def torn(self, poses: np.ndarray) -> float:
        """How far a joint's two bones take it apart: the median, as a share of the bone's length."""
        ends = [np.einsum("fbij,bj->fbi", poses[:, of][..., :3], self.places) + poses[:, of][..., 3]
                for of in (self.child, self.parent)]
        scale = np.cbrt(np.abs(np.linalg.det(poses[:, self.parent][..., :3])))
        return float(np.median(np.linalg.norm(ends[0] - ends[1], axis=-1) / np.maximum(scale * self.lengths, 1e-30)))


def _times(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The product of matrices (..., 3, 4)."""
    out = left[..., :3] @ right
    out[..., 3] += left[..., 3]
    return out


def _inverse(matrices: np.ndarray) -> np.ndarray:
    linear = np.linalg.pinv(matrices[..., :3])
    return np.concatenate([linear, -linear @ matrices[..., 3:]], -1)
