# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a skinned character with clips as a binary glTF, and reads clips back. Plain Python and numpy, without Blender.

A pose is an array of (frames, joints, 4, 4) local matrices: each joint in its parent's space.
"""

import json
import struct

import numpy as np

COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
NUMBERS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}


def quaternions(rotations):
    """Unit quaternions (x, y, z, w) of rotation matrices (..., 3, 3); each continues the sign of the one before it."""
    m = rotations
    trace = [
        1 + m[..., 0, 0] - m[..., 1, 1] - m[..., 2, 2],
        1 - m[..., 0, 0] + m[..., 1, 1] - m[..., 2, 2],
        1 - m[..., 0, 0] - m[..., 1, 1] + m[..., 2, 2],
        1 + m[..., 0, 0] + m[..., 1, 1] + m[..., 2, 2],
    ]
    a, b, c = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    d, e, f = m[..., 1, 0] + m[..., 0, 1], m[..., 0, 2] + m[..., 2, 0], m[..., 2, 1] + m[..., 1, 2]
    rows = np.stack([np.stack(row, -1) for row in [(trace[0], d, e, a), (d, trace[1], f, b), (e, f, trace[2], c),
                                                    (a, b, c, trace[3])]], -2)
    best = np.argmax(np.stack(trace, -1), -1)
    q = np.take_along_axis(rows, best[..., None, None], -2)[..., 0, :]
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    if q.ndim > 1 and len(q) > 1:
        turned = np.sum(q[1:] * q[:-1], -1) < 0
        q[1:] *= np.where(np.cumsum(turned, 0) % 2 == 1, -1.0, 1.0)[..., None]
    return q


def split(matrices):
    """Translations, quaternions and scales of matrices (..., 4, 4). Shear is dropped."""
    linear = matrices[..., :3, :3]
    scales = np.linalg.norm(linear, axis=-2)
    scales = np.where(scales > 1e-9, scales, 1e-9)
    scales = scales * np.where(np.linalg.det(linear) < 0, -1.0, 1.0)[..., None]
    return matrices[..., :3, 3], quaternions(linear / scales[..., None, :]), scales


class Writer:
    """Collects accessors and nodes; `save` writes the file."""

    def __init__(self):
        self.gltf = {"asset": {"version": "2.0"}, "scene": 0, "nodes": [], "meshes": [], "materials": [], "skins": [],
                     "animations": [], "accessors": [], "bufferViews": []}
        self.data = bytearray()

    def accessor(self, values, number, kind, bounds=False):
        values = np.ascontiguousarray(values, NUMBERS[number])
        count = values.size // COMPONENTS[kind]
        entry = {"bufferView": len(self.gltf["bufferViews"]), "componentType": number, "count": count, "type": kind}
        if bounds:
            table = values.reshape(count, -1)
            entry["min"], entry["max"] = table.min(0).tolist(), table.max(0).tolist()
        self.gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes})
        self.gltf["accessors"].append(entry)
        self.data += values.tobytes()
        self.data += b"\0" * (-len(self.data) % 4)
        return len(self.gltf["accessors"]) - 1

    def node(self, **keys):
        self.gltf["nodes"].append(keys)
        return len(self.gltf["nodes"]) - 1

    def material(self, name, alpha_mode):
        entry = {"name": name, "alphaMode": alpha_mode}
        if entry not in self.gltf["materials"]:
            self.gltf["materials"].append(entry)
        return self.gltf["materials"].index(entry)

    def mesh(self, name, skin, primitives):
        """One node with a skinned mesh. A primitive holds positions, joints and weights (n, 4 or 8), triangles, material."""
        entries = []
        for primitive in primitives:
            attributes = {"POSITION": self.accessor(primitive["positions"], 5126, "VEC3", bounds=True)}
            for at in range(0, primitive["joints"].shape[1], 4):
                attributes[f"JOINTS_{at // 4}"] = self.accessor(primitive["joints"][:, at:at + 4], 5123, "VEC4")
                attributes[f"WEIGHTS_{at // 4}"] = self.accessor(primitive["weights"][:, at:at + 4], 5126, "VEC4")
            entries.append({"attributes": attributes, "indices": self.accessor(primitive["triangles"], 5125, "SCALAR")})
            if primitive.get("material"):
                entries[-1]["material"] = self.material(*primitive["material"])
        self.gltf["meshes"].append({"name": name, "primitives": entries})
        return self.node(name=name, mesh=len(self.gltf["meshes"]) - 1, skin=skin)

    def clip(self, name, nodes, pose, fps):
        """A key at each frame for every channel that changes. A translation or scale that stays is that of its node."""
        times = self.accessor(np.arange(len(pose)) / fps, 5126, "SCALAR", bounds=True)
        samplers, channels = [], []
        for path, kind, values in zip(("translation", "rotation", "scale"), ("VEC3", "VEC4", "VEC3"), split(pose)):
            for at, node in enumerate(nodes):
                track = values[:, at]
                if np.abs(track - self.gltf["nodes"][node][path]).max() < 1e-6 and path != "rotation":
                    continue
                samplers.append({"input": times, "output": self.accessor(track, 5126, kind)})
                channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": path}})
        self.gltf["animations"].append({"name": name, "samplers": samplers, "channels": channels})

    def save(self, path):
        gltf = {key: value for key, value in self.gltf.items() if value != []}
        gltf["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(gltf, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sIII4s", b"glTF", 2, 28 + len(text) + len(self.data), len(text), b"JSON"))
            file.write(text + struct.pack("<I4s", len(self.data), b"BIN\0") + self.data)


def read(path):
    """The JSON and the binary part of a .glb."""
    with open(path, "rb") as file:
        data = file.read()
    size = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + size]), data[28 + size:]


def values(gltf, binary, number):
    """An accessor's rows as floats."""
    accessor = gltf["accessors"][number]
    view = gltf["bufferViews"][accessor["bufferView"]]
    kind = np.dtype(NUMBERS[accessor["componentType"]])
    width = COMPONENTS[accessor["type"]]
    stride = view.get("byteStride", 0) or kind.itemsize * width
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    rows = np.ndarray((accessor["count"], width), kind, binary, start, (stride, kind.itemsize)).astype(float)
    return rows / np.iinfo(kind).max if accessor.get("normalized") else rows


def rotations(path, names, frames, fps):
    """Quaternions (frames, names, 4) of the first clip of a .glb, at `frames` frames of `fps`."""
    gltf, binary = read(path)
    places = {node.get("name"): at for at, node in enumerate(gltf["nodes"])}
    clip = gltf["animations"][0]
    tracks = {channel["target"]["node"]: clip["samplers"][channel["sampler"]]
              for channel in clip["channels"] if channel["target"]["path"] == "rotation"}
    result = np.zeros((frames, len(names), 4))
    for at, name in enumerate(names):
        node = places[name]
        if node not in tracks:
            result[:, at] = gltf["nodes"][node].get("rotation", [0, 0, 0, 1])
            continue
        times = values(gltf, binary, tracks[node]["input"])[:, 0]
        keys = values(gltf, binary, tracks[node]["output"])
        place = np.interp(np.arange(frames) / fps, times, np.arange(len(times)))
        before = np.minimum(place.astype(int), max(len(times) - 2, 0))
        result[:, at] = blend(keys[before], keys[np.minimum(before + 1, len(times) - 1)], (place - before)[:, None])
    return result


def blend(first, second, share):
    """Between two quaternions at constant speed, the shorter way."""
    cosine = np.sum(first * second, -1, keepdims=True)
    second = np.where(cosine < 0, -second, second)
    angle = np.arccos(np.clip(np.abs(cosine), 0, 1))
    near = angle < 1e-4
    sine = np.where(near, 1, np.sin(angle))
    mixed = np.where(near, 1 - share, np.sin((1 - share) * angle) / sine) * first
    mixed = mixed + np.where(near, share, np.sin(share * angle) / sine) * second
    return mixed / np.linalg.norm(mixed, axis=-1, keepdims=True)


def angles(first, second):
    """Degrees between quaternions."""
    sine = np.minimum(np.linalg.norm(first - second, axis=-1), np.linalg.norm(first + second, axis=-1)) / 2
    return np.degrees(4 * np.arcsin(np.clip(sine, 0, 1)))
