# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene as glTF 2.0: .glb, or .gltf with its bytes beside it or inside it."""
import base64
import json
import struct
from urllib.parse import quote

import numpy as np

from scene import Node, matrix_quat
from vary import UP, mesh_space, share_skins

FORM = {"morphs", "several meshes", "joint axes", "node above", "rest", "mesh space", "sparse", "one name"}
FLOAT, U8, I16, U16, U32 = 5126, 5121, 5122, 5123, 5125
TYPES = {FLOAT: "<f4", U8: "u1", I16: "<i2", U16: "<u2", U32: "<u4", 5120: "i1"}
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class Bytes:
    """The buffers, their views and accessors."""

    def __init__(self, draw):
        self.draw, self.buffers, self.views, self.accessors = draw, [bytearray()], [], []
        self.several = draw.yes("several buffers", 0.15)
        self.padded = draw.yes("gaps in buffers", 0.2)
        self.strided = draw.yes("strided views", 0.2)
        self.sparse = draw.yes("sparse accessors", 0.2)
        self.rng = draw.rng("buffers")

    def view(self, data, **more):
        if self.several and self.rng.random() < 0.3:
            self.buffers.append(bytearray())
        buffer = len(self.buffers) - 1
        out = self.buffers[buffer]
        out += b"\0" * (-len(out) % 4)
        if self.padded:
            out += bytes(self.rng.randrange(256) for _ in range(4 * self.rng.randrange(4)))
        self.views.append({"buffer": buffer, "byteOffset": len(out), "byteLength": len(data), **more})
        out += data
        return len(self.views) - 1

    def add(self, values, component=FLOAT, normalized=False, bounds=False, vertex=False, plain=False, target=None):
        """An accessor of the rows of `values`; `vertex`: its rows begin at multiples of 4 bytes."""
        values = np.atleast_2d(np.asarray(values, dtype=TYPES[component]))
        count, width = values.shape
        size = values.dtype.itemsize * width
        accessor = {"componentType": component, "count": count, "type": KINDS[width]}
        if normalized:
            accessor["normalized"] = True
        if bounds:
            accessor["min"] = [float(v) if component == FLOAT else int(v) for v in values.min(0)]
            accessor["max"] = [float(v) if component == FLOAT else int(v) for v in values.max(0)]
        stored = values
        if self.sparse and not plain and count > 3 and self.rng.random() < 0.5:
            stored = self.sparsely(values, accessor, component)
        if stored is not None:
            stride = (size + 3) // 4 * 4 if vertex else size
            if vertex and self.strided:
                stride += 4 * self.rng.randrange(0, 4)
            offset = 4 * self.rng.randrange(0, 3) if self.padded else 0
            if stride == size:
                data = b"\xaa" * offset + stored.tobytes()
            else:
                data = bytearray(b"\xaa" * (offset + stride * count))
                for k, row in enumerate(stored):
                    data[offset + k * stride:offset + k * stride + size] = row.tobytes()
            more = {} if target is None or self.rng.random() < 0.5 else {"target": target}
            if vertex and (stride != size or self.rng.random() < 0.3):
                more["byteStride"] = stride
            accessor["bufferView"] = self.view(bytes(data), **more)
            if offset:
                accessor["byteOffset"] = offset
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def sparsely(self, values, accessor, component):
        """Some rows wrong in the view and right in the sparse part; or all but zeros in the sparse part."""
        zeros = self.rng.random() < 0.3 and values.shape[1] > 1  # tinygltf refuses indices without a view
        rows = [k for k in range(len(values)) if (zeros and np.any(values[k] != 0)) or
                (not zeros and self.rng.random() < 0.2)] or [0]
        index = U32 if len(values) > 65535 or self.rng.random() < 0.3 else U16
        accessor["sparse"] = {
            "count": len(rows),
            "indices": {"bufferView": self.view(np.array(rows, TYPES[index]).tobytes()), "componentType": index},
            "values": {"bufferView": self.view(values[rows].tobytes())}}
        if zeros:
            return None
        wrong = values.copy()
        wrong[rows] = 0
        return wrong

    def interleave(self, columns):
        """Accessors that share one view: (values, component, normalized, bounds) each."""
        packed = [np.asarray(v, TYPES[c]) for v, c, _, _ in columns]
        offsets, stride = [], 0
        for p in packed:
            offsets.append(stride)
            stride += (p.dtype.itemsize * p.shape[1] + 3) // 4 * 4
        data = np.zeros((len(packed[0]), stride), np.uint8)
        for p, at in zip(packed, offsets):
            raw = np.frombuffer(np.ascontiguousarray(p).tobytes(), np.uint8).reshape(len(p), -1)
            data[:, at:at + raw.shape[1]] = raw
        view = self.view(data.tobytes(), byteStride=stride)
        out = []
        for p, at, (_, c, normalized, bounds) in zip(packed, offsets, columns):
            accessor = {"bufferView": view, "byteOffset": at, "componentType": c, "count": len(p),
                        "type": KINDS[p.shape[1]]}
            if normalized:
                accessor["normalized"] = True
            if bounds:
                accessor["min"], accessor["max"] = p.min(0).tolist(), p.max(0).tolist()
            self.accessors.append(accessor)
            out.append(len(self.accessors) - 1)
        return out


def quantize(scene, draw):
    """Positions as integers: the mesh's space becomes that of the integers."""
    kind = draw.pick("quantized positions", None, ["short", "unsigned short", "normalized short",
                                                   "normalized unsigned short"], 0.25)
    if kind is None:
        return None
    for mesh in scene.meshes:
        points = [mesh.positions] + [mesh.positions + d for _, d, _ in mesh.morphs]
        low, high = np.min([p.min(0) for p in points], 0), np.max([p.max(0) for p in points], 0)
        span = float((high - low).max()) * 1.01
        signed = not kind.endswith("unsigned short")
        g = np.eye(4)
        if signed:
            g[:3, :3] *= 2 / span
            g[:3, 3] = -(low + high) / span
        else:
            g[:3, :3] /= span
            g[:3, 3] = -low / span
        most = 32767 if signed else 65535
        if not kind.startswith("normalized"):
            g[:3] *= most
        mesh_space(mesh, g)
        mesh.quantized = (I16 if signed else U16, kind.startswith("normalized"), most)
    share_skins(scene)
    return kind


def integers(positions, quantized):
    component, normalized, most = quantized
    return np.round(positions * (most if normalized else 1))


def weight_sets(mesh, draw):
    """Bones and weights in sets of four, as floats or as integers of the same sum."""
    bones, weights = mesh.bones, mesh.weights
    bones = np.where(weights > 0, bones, 0)
    if draw.yes("weights in the second set", 0.1) and bones.shape[1] <= 4:
        gap = 4 - bones.shape[1] + 1
        bones = np.hstack([bones[:, :1], np.zeros((len(bones), gap + 2), int), bones[:, 1:]])
        weights = np.hstack([weights[:, :1], np.zeros((len(bones), gap + 2)), weights[:, 1:]])
    pad = -bones.shape[1] % 4
    bones = np.hstack([bones, np.zeros((len(bones), pad), int)])
    weights = np.hstack([weights, np.zeros((len(bones), pad))])
    kind = draw.pick("weights as", FLOAT, [U8, U16], 0.3)
    if kind != FLOAT:
        most = 255 if kind == U8 else 65535
        rounded = np.round(weights * most)
        if not draw.yes("weights sum by rounding", 0.3):
            rounded[np.arange(len(rounded)), rounded.argmax(1)] += most - rounded.sum(1)
        weights = rounded
    elif draw.yes("rounded weights", 0.2):
        weights = np.round(weights, 3)
    return bones, weights, kind


def triangles_of(mesh, draw, primitive, data):
    """The primitive's mode and indices; gives the order of vertices where there are no indices."""
    count = len(mesh.positions)
    kind = draw.pick("triangles as", "list", ["no indices", "strip", "fan", "32 bits", "strips of one"], 0.4)
    corners = mesh.triangles
    if kind == "no indices":
        return corners.reshape(-1)
    flat = corners.reshape(-1)
    if kind in ("strip", "strips of one"):
        # Triangles one after another, joined by such without area; those at odd places are turned.
        strip = []
        for t in corners.tolist():
            if strip:
                strip += [strip[-1], t[0]]
                if len(strip) % 2 == 1:
                    strip.append(t[0])
            strip += t
        flat, primitive["mode"] = np.array(strip), 5
    elif kind == "fan" and len(corners) > 0:
        primitive["fans"] = fans(corners)
        return None
    component = U32 if kind == "32 bits" else U8 if count <= 255 and draw.yes("8 bit indices", 0.7) else U16
    if count > 65534:
        component = U32
    primitive["indices"] = data.add(flat.reshape(-1, 1), component, plain=draw.rng("sparse indices").random() < 0.7,
                                    target=34963)
    if kind == "list" and draw.rng("mode said").random() < 0.3:
        primitive["mode"] = 4
    return None


def fans(corners):
    """Pairs of triangles that share an edge, as fans of four corners; the rest as fans of three."""
    out, k, c = [], 0, corners.tolist()
    while k < len(c):
        a = c[k]
        if k + 1 < len(c) and c[k + 1][0] == a[0] and c[k + 1][1] == a[2]:
            out.append(a + [c[k + 1][2]])
            k += 2
        else:
            out.append(a)
            k += 1
    return out


def write_mesh(mesh, draw, data, gltf):
    primitive = {"attributes": {}}
    order = triangles_of(mesh, draw, primitive, data)
    take = slice(None) if order is None else order
    bones, weights, kind = weight_sets(mesh, draw)
    bones, weights = bones[take], weights[take]
    attributes = primitive["attributes"]
    quantized = getattr(mesh, "quantized", None)
    p = mesh.positions[take]
    position = (p, FLOAT, False, True) if quantized is None else (
        integers(p, quantized), quantized[0], quantized[1], True)
    joint_type = U16 if len(mesh.skin.joints) > 255 or draw.rng("joints as").random() < 0.4 else U8
    columns = {"POSITION": position}
    for k in range(bones.shape[1] // 4):
        columns[f"JOINTS_{k}"] = (bones[:, 4 * k:4 * k + 4], joint_type, False, False)
        columns[f"WEIGHTS_{k}"] = (weights[:, 4 * k:4 * k + 4], kind, kind != FLOAT, False)
    if draw.yes("normals and coordinates", 0.3):
        columns["NORMAL"] = (np.tile([0, 0, 1.0], (len(p), 1)), FLOAT, False, False)
        columns["TEXCOORD_0"] = (np.zeros((len(p), 2)), FLOAT, False, False)
        columns["_OWN"] = (np.zeros((len(p), 1)), FLOAT, False, False)
    names = list(columns)
    draw.rng("attribute order").shuffle(names)
    if draw.yes("interleaved", 0.2):
        attributes.update(zip(names, data.interleave([columns[n] for n in names])))
    else:
        for n in names:
            values, component, normalized, bounds = columns[n]
            attributes[n] = data.add(values, component, normalized, bounds, vertex=True, target=34962)
    targets = []
    for _, deltas, _ in mesh.morphs:
        d = deltas[take] if quantized is None else deltas[take]
        if quantized is not None:
            d = np.round(d * (32767 if quantized[1] else 1))
            targets.append({"POSITION": data.add(d, I16, quantized[1], True, vertex=True)})
        else:
            targets.append({"POSITION": data.add(d, FLOAT, False, True, vertex=True)})
    if targets:
        primitive["targets"] = targets
    out = {"name": mesh.name, "primitives": [primitive]}
    if "fans" in primitive:
        lists = primitive.pop("fans")
        # A primitive a fan would be thousands: the first ten are fans, the others a list.
        out["primitives"] = []
        for fan in lists[:10]:
            out["primitives"].append({**primitive, "mode": 6, "indices": data.add(np.array(fan).reshape(-1, 1), U16,
                                                                                  plain=True)})
        rest = [[f[0], f[k], f[k + 1]] for f in lists[10:] for k in range(1, len(f) - 1)]
        out["primitives"].append({**primitive, "indices": data.add(np.array(rest).reshape(-1, 1), U16, plain=True)})
    elif "indices" in primitive and "mode" not in primitive and draw.yes("several primitives", 0.2):
        flat = mesh.triangles
        cut = draw.rng("several primitives value").randrange(1, max(2, len(flat)))
        out["primitives"] = [{**primitive, "indices": data.add(part.reshape(-1, 1), U16, plain=True)}
                             for part in (flat[:cut], flat[cut:]) if len(part)]
    if mesh.morphs:
        out["weights"] = [w for _, _, w in mesh.morphs]
        if draw.rng("morph names").random() < 0.5:
            out["extras"] = {"targetNames": [n for n, _, _ in mesh.morphs]}
    gltf["meshes"].append(out)
    return len(gltf["meshes"]) - 1


def write_track(track, draw, rng, data, kind):
    """A sampler: the keys as they are, as steps, or as a spline that meets them."""
    values, times = track.values, track.times
    if track.path == "r":
        values = values.copy()
        for k in range(1, len(values)):
            if values[k] @ values[k - 1] < 0:
                values[k] = -values[k]
    dense = len(times) == 25
    if kind == "STEP" and not (dense and np.allclose(times * 30, np.round(times * 30), atol=1e-6)):
        kind = "LINEAR"
    if kind == "CUBICSPLINE" and not dense:
        kind = "LINEAR"
    if kind == "CUBICSPLINE":
        slopes = np.gradient(values, times, axis=0)
        values = np.stack([slopes, values, slopes], 1).reshape(-1, values.shape[1])
    component = FLOAT
    normalized = False
    if track.path == "r" and draw.yes("rotations as shorts", 0.1) and kind != "CUBICSPLINE":
        component, normalized, values = I16, True, np.round(values / np.abs(values).max(1, keepdims=True).clip(1) * 32767)
    key = times.tobytes()
    if draw.rng("shared times").random() < 0.5 or key not in data.times:
        data.times[key] = data.add(times.reshape(-1, 1), bounds=True)
    sampler = {"input": data.times[key], "output": data.add(values, component, normalized)}
    if kind != "LINEAR" or rng.random() < 0.5:
        sampler["interpolation"] = kind
    return sampler


def write_animation(animation, draw, number, data, gltf, index):
    kind = draw.pick("interpolation", "LINEAR", ["STEP", "CUBICSPLINE", "mixed"], 0.35)
    rng = draw.rng(f"interpolation values {animation.name}")
    samplers, channels = [], []
    for track in animation.tracks:
        own = rng.choice(["LINEAR", "STEP", "CUBICSPLINE"]) if kind == "mixed" else kind
        samplers.append(write_track(track, draw, rng, data, own))
        path = {"t": "translation", "r": "rotation", "s": "scale"}[track.path]
        channels.append({"sampler": len(samplers) - 1, "target": {"node": number[id(track.node)], "path": path}})
    if draw.yes("channel without a node", 0.1):
        channels.append({"sampler": 0, "target": {"path": channels[0]["target"]["path"]}})
    rng.shuffle(channels)
    out = {"samplers": samplers, "channels": channels}
    if draw.rng("animation name").random() < 0.8:
        out["name"] = animation.name
    gltf["animations"].append(out)


def stand_up(scene, draw):
    """glTF is in metres and y is up: a node above turns and scales other axes and units."""
    if scene.unit == 1 and scene.up_name == "y":
        return
    node = Node("Axes")
    node.r = matrix_quat(UP[scene.up_name].T)
    node.s = np.full(3, scene.unit)
    for root in [n for n in scene.nodes if n.parent is None]:
        root.parent = node
    scene.nodes.append(node)


def write(scene, folder, draw):
    stand_up(scene, draw)
    quantized = quantize(scene, draw)
    data = Bytes(draw)
    data.times = {}
    gltf = {"asset": {"version": "2.0"}, "nodes": [], "meshes": [], "skins": [], "animations": []}
    number = {id(n): k for k, n in enumerate(scene.nodes)}
    by_matrix = draw.yes("matrices", 0.3)
    animated = {id(t.node) for a in scene.animations for t in a.tracks}
    rng = draw.rng("nodes")
    for node in scene.nodes:
        out = {}
        if node.name is not None:
            out["name"] = node.name
        if by_matrix and id(node) not in animated and rng.random() < 0.7:
            out["matrix"] = node.local().T.reshape(-1).tolist()
        else:
            for key, value, plain in (("translation", node.t, [0, 0, 0]), ("rotation", node.r, [0, 0, 0, 1]),
                                      ("scale", node.s, [1, 1, 1])):
                if not np.array_equal(value, plain) or rng.random() < 0.2:
                    out[key] = [float(v) for v in value]
        children = [number[id(n)] for n in scene.nodes if n.parent is node]
        if children:
            rng.shuffle(children)
            out["children"] = children
        gltf["nodes"].append(out)
    for skin in scene.skins:
        out = {"joints": [number[id(j)] for j in skin.joints]}
        binds = np.array([b.T.reshape(-1) for b in skin.inverse_binds])
        if np.allclose(binds, np.eye(4).reshape(-1), atol=1e-12):
            if not draw.yes("no inverse binds", 0.7):
                out["inverseBindMatrices"] = data.add(binds)
        else:
            out["inverseBindMatrices"] = data.add(binds, plain=draw.rng("sparse binds").random() < 0.7)
        root = [j for j in skin.joints if j.parent not in skin.joints]
        where = draw.pick("skeleton", None, ["root", "above"], 0.4)
        if where and len(root) == 1:
            top = root[0]
            if where == "above":
                while top.parent is not None:
                    top = top.parent
            out["skeleton"] = number[id(top)]
        gltf["skins"].append(out)
    for mesh in scene.meshes:
        m = write_mesh(mesh, draw, data, gltf)
        holder = gltf["nodes"][number[id(mesh.node)]]
        holder["mesh"], holder["skin"] = m, scene.skins.index(mesh.skin)
        if mesh.morphs and draw.yes("weights on the node", 0.3):
            holder["weights"] = gltf["meshes"][m]["weights"]
            gltf["meshes"][m]["weights"] = [0.1] * len(mesh.morphs)
    if draw.yes("mesh node moved", 0.3):
        # A skinned mesh's own node does not move it.
        r = draw.rng("mesh node moved values")
        for mesh in scene.meshes:
            holder = gltf["nodes"][number[id(mesh.node)]]
            holder.pop("matrix", None)
            holder["translation"] = [r.uniform(-2, 2) for _ in range(3)]
            holder["scale"] = [r.choice([1, 100, 0.01])] * 3
    for animation in scene.animations:
        write_animation(animation, draw, number, data, gltf, 0)
    extras(scene, gltf, draw, number, data)
    roots = [number[id(n)] for n in scene.nodes if n.parent is None]
    finish_scenes(scene, gltf, draw, roots, number)
    if quantized:
        gltf.setdefault("extensionsUsed", []).append("KHR_mesh_quantization")
        gltf["extensionsRequired"] = ["KHR_mesh_quantization"]
    gltf["accessors"], gltf["bufferViews"] = data.accessors, data.views
    return pack(gltf, data.buffers, folder, draw)


def finish_scenes(scene, gltf, draw, roots, number):
    meshes = {number[id(m.node)] for m in scene.meshes}
    if draw.yes("joints outside the scene", 0.08) and meshes & set(roots):
        gltf["scenes"] = [{"nodes": sorted(meshes & set(roots))}]
    else:
        gltf["scenes"] = [{"nodes": roots}]
    gltf["scene"] = 0
    kind = draw.pick("scenes", None, ["no default", "second", "one empty"], 0.2)
    if kind == "no default":
        del gltf["scene"]
    elif kind == "second":
        gltf["scenes"].insert(0, {"name": "empty"})
        gltf["scene"] = 1
    elif kind == "one empty":
        gltf["scenes"].append({"name": "other"})


def extras(scene, gltf, draw, number, data):
    if draw.yes("cameras and lights", 0.15):
        gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]
        gltf["extensionsUsed"] = ["KHR_lights_punctual"]
        gltf["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}
        for node in gltf["nodes"]:
            if "mesh" not in node:
                node["camera"] = 0
                node["extensions"] = {"KHR_lights_punctual": {"light": 0}}
                break
    if draw.yes("materials", 0.2):
        gltf.setdefault("extensionsUsed", []).append("KHR_materials_unlit")
        gltf["materials"] = [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.4, 0.3, 1]}, "doubleSided": True,
                              "extensions": {"KHR_materials_unlit": {}}}]
        for mesh in gltf["meshes"]:
            for primitive in mesh["primitives"]:
                primitive["material"] = 0
    if draw.yes("unknown extension", 0.1):
        gltf.setdefault("extensionsUsed", []).append("EXT_of_somebody")
        gltf["nodes"][0]["extensions"] = {**gltf["nodes"][0].get("extensions", {}), "EXT_of_somebody": {"a": [1, None]}}
    if draw.yes("extras", 0.2):
        gltf["extras"] = {"why": "\u00e4\u4e2d\U0001f600", "deep": [[[{}]]]}
        for node in gltf["nodes"][::3]:
            node["extras"] = "text"
        gltf["asset"].update(generator="fuzz", copyright="", minVersion="2.0")


def pack(gltf, buffers, folder, draw):
    for key in [k for k, v in gltf.items() if isinstance(v, list) and not v]:
        del gltf[key]
    kind = draw.pick("container", "glb", ["beside", "inside", "octets", "glb and bin"], 0.5)
    gltf["buffers"] = [{"byteLength": len(b)} for b in buffers]
    names = draw.pick("buffer names", "buffer{}.bin", ["a b{}.bin", "\u00e4{}.bin", "data/b{}.bin", "b%{}.bin"], 0.3)

    def beside(k):
        name = names.format(k)
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(buffers[k])
        gltf["buffers"][k]["uri"] = quote(name)

    first = 1 if kind.startswith("glb") else 0
    for k in range(first, len(buffers)):
        if kind in ("beside", "glb and bin"):
            beside(k)
        else:
            mime = "application/octet-stream" if kind == "octets" else "application/gltf-buffer"
            gltf["buffers"][k]["uri"] = f"data:{mime};base64," + base64.b64encode(buffers[k]).decode()
    keys = list(gltf)
    if draw.yes("keys shuffled", 0.2):
        draw.rng("keys shuffled order").shuffle(keys)
    indent = draw.pick("indented", None, [2], 0.2)
    text = json.dumps({k: gltf[k] for k in keys}, ensure_ascii=draw.rng("escapes").random() < 0.5, indent=indent)
    encoded = text.encode()
    if first == 0:
        path = folder / "man.gltf"
        path.write_bytes(encoded)
        return path
    encoded += b" " * (-len(encoded) % 4)
    body = bytes(buffers[0]) + b"\0" * (-len(buffers[0]) % 4)
    chunks = struct.pack("<I4s", len(encoded), b"JSON") + encoded + struct.pack("<I4s", len(body), b"BIN\0") + body
    if draw.yes("unknown chunk", 0.1):
        chunks += struct.pack("<I4s", 8, b"OWN\0") + b"12345678"
    path = folder / "man.glb"
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    return path
