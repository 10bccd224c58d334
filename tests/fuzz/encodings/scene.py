# SPDX-License-Identifier: GPL-3.0-or-later
"""A rigged character apart from any file format: nodes, meshes, skins, animations, and their evaluation.

Vectors are columns: a child's world matrix is its parent's times its own. Quaternions are x, y, z, w. Lengths and
axes are the scene's own.
"""
import copy

import numpy as np


def quat(axis_angle):
    """The rotation about a vector by its length in radians."""
    v = np.asarray(axis_angle, float)
    angle = np.linalg.norm(v)
    if angle < 1e-12:
        return np.array([0, 0, 0, 1.0])
    return np.append(v / angle * np.sin(angle / 2), np.cos(angle / 2))


def quat_times(a, b):
    """First b, then a."""
    av, bv = a[:3], b[:3]
    return np.append(a[3] * bv + b[3] * av + np.cross(av, bv), a[3] * b[3] - av @ bv)


def quat_inverse(q):
    return np.array([-q[0], -q[1], -q[2], q[3]])


def quat_matrix(q):
    x, y, z, w = np.asarray(q, float) / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def matrix_quat(m):
    """Of a rotation matrix, by its largest component, so that no division loses digits."""
    m = np.asarray(m, float)
    k = np.array([[m[0, 0] - m[1, 1] - m[2, 2], 0, 0, 0],
                  [m[0, 1] + m[1, 0], m[1, 1] - m[0, 0] - m[2, 2], 0, 0],
                  [m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], m[2, 2] - m[0, 0] - m[1, 1], 0],
                  [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], m[0, 0] + m[1, 1] + m[2, 2]]])
    values, vectors = np.linalg.eigh(k / 3)
    q = vectors[:, np.argmax(values)]
    return q if q[3] >= 0 else -q


def slerp(a, b, u):
    d = float(np.dot(a, b))
    if d < 0:
        b, d = -np.asarray(b), -d
    if d > 0.9999999:
        q = (1 - u) * np.asarray(a) + u * np.asarray(b)
    else:
        angle = np.arccos(d)
        q = (np.sin((1 - u) * angle) * np.asarray(a) + np.sin(u * angle) * np.asarray(b)) / np.sin(angle)
    return q / np.linalg.norm(q)


def trs(t, r, s):
    m = np.eye(4)
    m[:3, :3] = quat_matrix(r) * np.asarray(s, float)
    m[:3, 3] = t
    return m


def split_trs(m):
    """Translation, rotation and scale of a matrix without shear; a mirror becomes a negative x."""
    s = np.linalg.norm(m[:3, :3], axis=0)
    if np.linalg.det(m[:3, :3]) < 0:
        s = s * [-1, 1, 1]
    return m[:3, 3].copy(), matrix_quat(m[:3, :3] / s), s


class Node:
    def __init__(self, name, parent=None, t=(0, 0, 0), r=(0, 0, 0, 1), s=(1, 1, 1)):
        self.name, self.parent = name, parent  # parent: a Node
        self.t, self.r, self.s = np.array(t, float), np.array(r, float), np.array(s, float)
        self.as_matrix = False  # a writer that can writes its matrix
        self.role = None  # which joint of the man it is

    def local(self):
        return trs(self.t, self.r, self.s)


class Track:
    """One property of a node over time. Between keys rotations go along the great circle, the rest on a line."""

    def __init__(self, node, path, times, values, step=False):
        self.node, self.path = node, path  # path: t, r or s
        self.times, self.values = np.array(times, float), np.array(values, float)
        self.step = step

    def at(self, time):
        k = int(np.searchsorted(self.times, time + 1e-9, side="right")) - 1
        if k < 0:
            return self.values[0]
        if k + 1 >= len(self.times) or self.step:
            return self.values[min(k, len(self.times) - 1)]
        u = (time - self.times[k]) / (self.times[k + 1] - self.times[k])
        if self.path == "r":
            return slerp(self.values[k], self.values[k + 1], u)
        return (1 - u) * self.values[k] + u * self.values[k + 1]


class Animation:
    def __init__(self, name, tracks):
        self.name, self.tracks = name, tracks


class Skin:
    def __init__(self, joints, inverse_binds):
        self.joints, self.inverse_binds = joints, inverse_binds  # Nodes; 4x4 each


class Mesh:
    """Triangles with weights on the joints of a skin. `bones[v, k]` are numbers of the skin's joints."""

    def __init__(self, name, node, skin, positions, bones, weights, triangles):
        self.name, self.node, self.skin = name, node, skin
        self.positions, self.bones, self.weights = positions, bones, weights
        self.triangles = triangles
        self.morphs = []  # name, deltas, weight; each does nothing at its weight, or is a part of the positions


class Scene:
    def __init__(self):
        self.nodes, self.skins, self.meshes, self.animations = [], [], [], []
        self.unit = 1.0  # metres a unit
        self.up_name = "y"  # the axis that is up in the file

    def copy(self):
        return copy.deepcopy(self)

    def ordered(self):
        """Nodes, each after its parent, else as they are listed."""
        out, placed = [], set()

        def place(node):
            if id(node) in placed:
                return
            if node.parent is not None:
                place(node.parent)
            placed.add(id(node))
            out.append(node)

        for node in self.nodes:
            place(node)
        return out

    def worlds(self, animation=None, time=0.0):
        """World matrices by node, at rest or at a time."""
        posed = {}
        for track in animation.tracks if animation else []:
            posed.setdefault(id(track.node), {})[track.path] = track.at(time)
        out = {}
        for node in self.ordered():
            own = posed.get(id(node))
            local = node.local() if not own else trs(own.get("t", node.t), own.get("r", node.r), own.get("s", node.s))
            out[id(node)] = local if node.parent is None else out[id(node.parent)] @ local
        return out

    def skinned(self, animation=None, time=0.0):
        """World positions of all meshes' vertices, one array a mesh."""
        worlds = self.worlds(animation, time)
        out = []
        for mesh in self.meshes:
            skin = mesh.skin
            palette = np.array([worlds[id(j)] @ b for j, b in zip(skin.joints, skin.inverse_binds)])
            p = mesh.positions.copy()
            for _, deltas, weight in mesh.morphs:
                p = p + weight * deltas
            h = np.column_stack([p, np.ones(len(p))])
            moved = np.einsum("vk,vkij,vj->vi", mesh.weights, palette[mesh.bones], h)
            out.append(moved[:, :3])
        return out
