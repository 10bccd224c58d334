# SPDX-License-Identifier: MIT
"""Poses for tests and the benchmark: each joint turned at random, its children with it."""

import numpy as np


def rest_pose(model, dtype=np.float32):
    return np.tile(np.eye(3, 4, dtype=dtype), (len(model.bones), 1, 1))


def random_poses(model, count, degrees=40, seed=1, dtype=np.float32):
    """(count, bones, 3, 4). Joints hang on each other as the body parts that follow them do."""
    rng = np.random.default_rng(seed)
    parts = [part for part in model.parts if part.bone is not None]
    parent = {part.bone: model.parts[part.parent].bone for part in parts if part.parent is not None}
    out = np.tile(np.eye(4), (count, len(model.bones), 1, 1))
    turned = [rotations(rng.normal(size=(count, 3)) * np.radians(degrees) / 2) for _ in model.bones]
    for bone in range(len(model.bones)):
        chain = [bone]
        while parent.get(chain[-1], chain[-1]) not in chain:
            chain.append(parent[chain[-1]])
        for joint in chain:
            bind = model.bones[joint].inverse_bind.astype(float)
            place = -bind[:, :3].T @ bind[:, 3]
            turn = np.tile(np.eye(4), (count, 1, 1))
            turn[:, :3, :3] = turned[joint]
            turn[:, :3, 3] = place - turned[joint] @ place
            out[:, bone] = turn @ out[:, bone]
    return np.ascontiguousarray(out[:, :, :3], dtype)


def heap(model):
    """All joints in one place: more touches than any list is made for at first."""
    out = rest_pose(model)
    for bone, (_, bind) in enumerate(model.bones):
        out[bone, :, 3] = bind[:, :3].T @ bind[:, 3]
    return out


def rotations(vectors):
    """(n, 3) rotation vectors in radians -> (n, 3, 3)."""
    angles = np.linalg.norm(vectors, axis=1)[:, None, None]
    x, y, z = (vectors / np.maximum(angles[:, 0], 1e-12)).T
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], 1).reshape(-1, 3, 3)
    return np.eye(3) + np.sin(angles) * cross + (1 - np.cos(angles)) * cross @ cross
