# SPDX-License-Identifier: MIT
"""A reader of rigged .glb files, as small as it can be: the first skinned mesh, the skeleton and the clips. numpy alone."""

import json
import struct

import numpy as np

TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Character:
    """Nodes are the file's; matrices are 4 by 4, and take points as columns."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        if data[:4] != b"glTF":
            raise SystemExit(f"{path}: is no .glb file")
        (size,) = struct.unpack_from("<I", data, 12)
        self.json = json.loads(data[20:20 + size])
        self.binary = data[28 + size:]
        nodes = self.json["nodes"]
        self.names = [node.get("name", "") for node in nodes]
        self.parents = [-1] * len(nodes)
        for i, node in enumerate(nodes):
            for child in node.get("children", ()):
                self.parents[child] = i
        self.order = sorted(range(len(nodes)), key=self.depth)  # parents first
        self.read_skin()

    def depth(self, node):
        return 0 if self.parents[node] < 0 else 1 + self.depth(self.parents[node])

    def array(self, index):
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        dtype, columns = np.dtype(TYPES[accessor["componentType"]]), SIZES[accessor["type"]]
        stride = view.get("byteStride", dtype.itemsize * columns)
        out = np.ndarray((accessor["count"], columns), dtype, self.binary, start, (stride, dtype.itemsize))
        return out / np.iinfo(dtype).max if accessor.get("normalized") else out

    def read_skin(self):
        """positions (vertices, 3), triangles (triangles, 3), joints and weights (vertices, influences)."""
        node = next(node for node in self.json["nodes"] if "skin" in node and "mesh" in node)
        skin = self.json["skins"][node["skin"]]
        self.skin_nodes = skin["joints"]
        self.inverse_binds = self.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        parts, first = [], 0
        for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
            names = primitive["attributes"]
            positions = self.array(names["POSITION"])
            order = self.array(primitive["indices"]) if "indices" in primitive else np.arange(len(positions))
            parts.append((positions, order.reshape(-1, 3).astype(int) + first, self.array(names["JOINTS_0"]),
                          self.array(names["WEIGHTS_0"])))
            first += len(positions)
        self.positions, self.triangles, self.joints, self.weights = (np.concatenate(part) for part in zip(*parts))

    def clip(self, fps=30, index=0):
        """The clip's matrices of each node in its parent's space: (frames, nodes, 4, 4)."""
        animation = self.json["animations"][index]
        keys = [self.array(sampler["input"])[:, 0] for sampler in animation["samplers"]]
        times = np.arange(0, max(key[-1] for key in keys) + 0.05 / fps, 1 / fps)  # files round times
        nodes, count = self.json["nodes"], len(times)
        moved = {(i, path): np.tile(np.asarray(node.get(path, rest), float), (count, 1)) for i, node in enumerate(nodes)
                 for path, rest in (("translation", (0, 0, 0)), ("rotation", (0, 0, 0, 1)), ("scale", (1, 1, 1)))}
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            if channel["target"]["path"] == "weights" or sampler.get("interpolation") == "CUBICSPLINE":
                raise SystemExit("this small reader knows neither morph targets nor cubic splines")
            place = channel["target"]["node"], channel["target"]["path"]
            moved[place] = sample(keys[channel["sampler"]], self.array(sampler["output"]), times,
                                  place[1] == "rotation", sampler.get("interpolation") == "STEP")
        out = np.tile(np.eye(4), (count, len(nodes), 1, 1))
        for i, node in enumerate(nodes):
            if "matrix" in node:
                out[:, i] = np.reshape(node["matrix"], (4, 4)).T
            else:
                out[:, i, :3, :3] = matrices(moved[i, "rotation"]) * moved[i, "scale"][:, None]
                out[:, i, :3, 3] = moved[i, "translation"]
        return out

    def world(self, local):
        """From matrices in the parents' space, (..., nodes, 4, 4), to those in the world."""
        out = local.copy()
        for node in self.order:
            if self.parents[node] >= 0:
                out[..., node, :, :] = out[..., self.parents[node], :, :] @ local[..., node, :, :]
        return out

    def skinned(self, world):
        """The vertices of one pose: (vertices, 3)."""
        palette = (world[self.skin_nodes] @ self.inverse_binds)[:, :3]
        points = np.append(self.positions, np.ones((len(self.positions), 1)), 1)
        return np.einsum("vk,vkij,vj->vi", self.weights, palette[self.joints], points, optimize=True)


def sample(keys, values, times, turns, steps):
    """The values at the times: between two keys the mean by time, of quaternions made one again."""
    after = np.clip(np.searchsorted(keys, times, "right"), 1, max(1, len(keys) - 1))
    before, after = after - 1, np.minimum(after, len(keys) - 1)
    share = np.clip((times - keys[before]) / np.maximum(keys[after] - keys[before], 1e-9), 0, 1)[:, None]
    a, b = values[before].astype(float), values[after].astype(float)
    if turns:
        b = np.where((a * b).sum(1, keepdims=True) < 0, -b, b)
    out = a + (b - a) * (np.floor(share) if steps else share)
    return out / np.linalg.norm(out, axis=1, keepdims=True) if turns else out


def matrices(quaternions):
    """(n, 4) x, y, z, w -> (n, 3, 3)."""
    x, y, z, w = quaternions.T
    rows = [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w),
            1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w),
            1 - 2 * (x * x + y * y)]
    return np.stack(rows, 1).reshape(-1, 3, 3)
