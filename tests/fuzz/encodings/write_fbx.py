# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene as FBX 7.4, text or binary.

A node's local matrix is T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1. A skinned vertex goes from the mesh by its
geometric transform and its node at bind time to the world, and from there with the clusters' links.
"""
import struct
import zlib

import numpy as np

import euler
from scene import Node, quat_matrix
from vary import UP, reframe

FORM = {"root in skins", "several meshes", "joint axes", "node above", "rest", "mesh space", "one name"}
SECOND = 46186158000
ORDERS = ["xyz", "xzy", "yzx", "yxz", "zxy", "zyx"]


class Long(int):
    pass


class Record:
    def __init__(self, name, *values, inside=()):
        self.name, self.values, self.inside = name, values, list(inside)


def name_and_kind(name, kind, binary):
    return f"{name}\0\1{kind}" if binary else f"{kind}::{name}"


def text_of(record, depth, digits):
    pad = "\t" * depth
    shown, arrays = [], []
    for v in record.values:
        if isinstance(v, np.ndarray):
            arrays.append(v)
        elif isinstance(v, str):
            shown.append('"' + v.replace('"', "&quot;") + '"')
        else:
            shown.append(f"{v:.{digits}g}" if isinstance(v, float) else str(int(v)))
    out = f"{pad}{record.name}: " + ", ".join(shown)
    if arrays:
        numbers = ",".join(f"{v:.{digits}g}" if v.dtype.kind == "f" else str(int(v)) for v in arrays[0])
        return f"{pad}{record.name}: *{len(arrays[0])} {{\n{pad}\ta: {numbers}\n{pad}}}\n"
    if record.inside or record.name == "AnimationLayer":
        return out + " {\n" + "".join(text_of(r, depth + 1, digits) for r in record.inside) + pad + "}\n"
    return out + "\n"


def bytes_of(record, at, packed):
    values = b""
    for v in record.values:
        if isinstance(v, np.ndarray):
            kind = {"f8": "d", "i4": "i", "i8": "l", "f4": "f"}[v.dtype.str[1:]]
            raw = v.tobytes()
            body = zlib.compress(raw) if packed else raw
            values += kind.encode() + struct.pack("<III", len(v), int(packed), len(body)) + body
        elif isinstance(v, str):
            raw = v.encode()
            values += b"S" + struct.pack("<I", len(raw)) + raw
        elif isinstance(v, Long):
            values += b"L" + struct.pack("<q", v)
        elif isinstance(v, float):
            values += b"D" + struct.pack("<d", v)
        else:
            values += b"I" + struct.pack("<i", v)
    head = 13 + len(record.name)
    inside, place = b"", at + head + len(values)
    for r in record.inside:
        part = bytes_of(r, place, packed)
        inside += part
        place += len(part)
    if record.inside or record.name == "AnimationLayer":
        inside += b"\0" * 13
        place += 13
    return struct.pack("<IIIB", place, len(record.values), len(values), len(record.name)) + record.name.encode() + \
        values + inside


def property_of(name, kind, label, flags, *values):
    return Record("P", name, kind, label, flags, *values)


def lcl(name, values):
    return property_of(f"Lcl {name}", f"Lcl {name}", "", "A", *map(float, values))


def vector(name, values):
    return property_of(name, "Vector3D", "Vector", "", *map(float, values))


class NodeTransform:
    """How a node says its matrix: pre- and post-rotation, pivots, offsets, the order of its angles."""

    def __init__(self):
        self.order, self.pre, self.post = "xyz", np.zeros(3), np.zeros(3)
        self.rp, self.roff, self.sp, self.soff = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)

    def said(self, t, r, s):
        """T and the rotation R (a matrix) that make the local matrix of t, r, s."""
        pre, post = euler.matrix("xyz", self.pre), euler.matrix("xyz", self.post)
        turn = quat_matrix(r)
        own = pre.T @ turn @ post
        shift = self.roff + self.rp - turn @ self.rp + turn @ (self.soff + self.sp - s * self.sp)
        return t - shift, own


def ways_of(scene, draw):
    rng = draw.rng("fbx ways")
    pre = draw.yes("pre-rotations", 0.35)
    post = draw.yes("post-rotations", 0.2)
    order = draw.yes("rotation orders", 0.3)
    offsets = draw.yes("pivots and offsets", 0.25)
    pivots = draw.yes("turned about pivots", 0.2)
    animated = {id(t.node) for a in scene.animations for t in a.tracks if t.path == "r"}
    ways = {}

    def angle():
        return np.array([rng.choice([0, 90, -90, 180, rng.uniform(-180, 180)]) for _ in range(3)], float)

    def length():
        return np.array([rng.uniform(-0.2, 0.2) for _ in range(3)]) / scene.unit

    right = {}
    for node in scene.nodes:
        way = ways[id(node)] = NodeTransform()
        if node.role is None:
            continue
        if pre and rng.random() < 0.7:
            way.pre = angle()
        if post and rng.random() < 0.7:
            way.post = angle()
        if order:
            way.order = rng.choice(ORDERS)
        if offsets and id(node) not in animated:
            way.rp, way.roff, way.sp, way.soff = length(), length(), length(), length()
        if pivots and id(node) in animated:
            way.rp = length()
            right[id(node)] = np.eye(4)
            right[id(node)][:3, 3] = -way.rp
    if right:
        reframe(scene, right)
    return ways


def model(scene, node, ways, number, kind, draw, binary, more=()):
    way = ways[id(node)]
    t, own = way.said(node.t, node.r, node.s)
    properties = [property_of("InheritType", "enum", "", "", 1)]
    turned = way.order != "xyz" or way.pre.any() or way.post.any()
    if turned or draw.rng("rotation active").random() < 0.5:
        properties.append(property_of("RotationActive", "bool", "", "", 1))
    if way.order != "xyz":
        properties.append(property_of("RotationOrder", "enum", "", "", ORDERS.index(way.order)))
    for name, values in (("PreRotation", way.pre), ("PostRotation", way.post), ("RotationPivot", way.rp),
                         ("RotationOffset", way.roff), ("ScalingPivot", way.sp), ("ScalingOffset", way.soff)):
        if np.any(values):
            properties.append(vector(name, values))
    properties += [lcl("Translation", t), lcl("Rotation", euler.angles(way.order, own)), lcl("Scaling", node.s)]
    return Record("Model", Long(number), name_and_kind(node.name, "Model", binary), kind, inside=[
        Record("Version", 232), Record("Properties70", inside=properties + list(more)), Record("Shading", 1),
        Record("Culling", "CullingOff")])


def flat(m):
    return np.asarray(m, float).T.reshape(-1).copy()


class Writer:
    def __init__(self, scene, draw):
        self.scene, self.draw = scene, draw
        self.binary = draw.yes("binary", 0.4)
        self.objects, self.links = [], []
        self.next = 1000
        self.number = {}

    def new(self):
        self.next += 1
        return self.next

    def link(self, child, parent, place=None):
        self.links.append(Record("C", "OO", Long(child), Long(parent)) if place is None else
                          Record("C", "OP", Long(child), Long(parent), place))

    def add_nodes(self, ways):
        scene = self.scene
        joints = {id(j) for s in scene.skins for j in s.joints}
        meshes = {id(m.node): m for m in scene.meshes}
        for node in scene.nodes:
            self.number[id(node)] = self.new()
        for node in scene.nodes:
            more = []
            kind = "LimbNode" if node.role or id(node) in joints else "Mesh" if id(node) in meshes else "Null"
            if id(node) in meshes:
                more = meshes[id(node)].geometric
            self.objects.append(model(scene, node, ways, self.number[id(node)], kind, self.draw, self.binary, more))
            self.link(self.number[id(node)], self.number[id(node.parent)] if node.parent else 0)
            if kind in ("LimbNode", "Null") and self.draw.rng("attributes").random() < 0.7:
                attribute = self.new()
                kinds = ("LimbNode", "Skeleton") if kind == "LimbNode" else ("Null", "Null")
                self.objects.append(Record("NodeAttribute", Long(attribute),
                                           name_and_kind(node.name, "NodeAttribute", self.binary), kinds[0],
                                           inside=[Record("TypeFlags", kinds[1])]))
                self.link(attribute, self.number[id(node)])

    def add_mesh(self, mesh):
        """Vertices lie so that the geometric transform and the node at bind time take them to the skin's space."""
        geometry, skin = self.new(), self.new()
        bind = mesh.bind
        v = (np.linalg.inv(bind @ mesh.offset) @ np.column_stack([mesh.positions, np.ones(len(mesh.positions))]).T).T
        corners = mesh.triangles
        if np.linalg.det((bind @ mesh.offset)[:3, :3]) < 0:
            corners = corners[:, ::-1]
        index = corners.copy()
        index[:, 2] = -index[:, 2] - 1
        inside = [Record("Vertices", v[:, :3].reshape(-1).astype("<f8")),
                  Record("PolygonVertexIndex", index.reshape(-1).astype("<i4")), Record("GeometryVersion", 124)]
        if self.draw.yes("normals", 0.3):
            normals = np.tile([0, 0, 1.0], (index.size, 1))
            inside.append(Record("LayerElementNormal", 0, inside=[
                Record("Version", 101), Record("Name", ""), Record("MappingInformationType", "ByPolygonVertex"),
                Record("ReferenceInformationType", "Direct"), Record("Normals", normals.reshape(-1).astype("<f8"))]))
            inside.append(Record("Layer", 0, inside=[Record("Version", 100), Record("LayerElement", inside=[
                Record("Type", "LayerElementNormal"), Record("TypedIndex", 0)])]))
        self.objects.append(Record("Geometry", Long(geometry), name_and_kind(mesh.name, "Geometry", self.binary),
                                   "Mesh", inside=inside))
        self.link(geometry, self.number[id(mesh.node)])
        self.objects.append(Record("Deformer", Long(skin), name_and_kind("", "Deformer", self.binary), "Skin", inside=[
            Record("Version", 101), Record("Link_DeformAcuracy", 50.0)]))
        self.link(skin, geometry)
        unused = self.draw.yes("clusters without weights", 0.3)
        for k, joint in enumerate(mesh.skin.joints):
            weight = np.where(mesh.bones == k, mesh.weights, 0).sum(1)
            rows = np.nonzero(weight)[0]
            if not len(rows) and not unused:
                continue
            to_world = np.linalg.inv(mesh.skin.inverse_binds[k])
            cluster = self.new()
            inside = [Record("Version", 100), Record("UserData", "", "")]
            if len(rows):
                inside += [Record("Indexes", rows.astype("<i4")), Record("Weights", weight[rows].astype("<f8"))]
            inside += [Record("Transform", flat(np.linalg.inv(to_world) @ bind)), Record("TransformLink", flat(to_world))]
            self.objects.append(Record("Deformer", Long(cluster), name_and_kind("", "SubDeformer", self.binary),
                                       "Cluster", inside=inside))
            self.link(cluster, skin)
            self.link(self.number[id(joint)], cluster)

    def add_curve(self, node, values, times, place, axis, kind):
        curve = self.new()
        flags = {"linear": 4, "cubic": 8 | 256, "constant": 2}[kind]
        n = len(times)
        self.objects.append(Record("AnimationCurve", Long(curve), name_and_kind("", "AnimCurve", self.binary), "", inside=[
            Record("Default", float(values[0])), Record("KeyVer", 4008),
            Record("KeyTime", np.round(np.array(times) * SECOND).astype("<i8")),
            Record("KeyValueFloat", np.array(values).astype("<f4")),
            Record("KeyAttrFlags", np.array([flags], "<i4")), Record("KeyAttrDataFloat", np.zeros(4, "<f4")),
            Record("KeyAttrRefCount", np.array([n], "<i4"))]))
        self.link(curve, node, f"d|{'XYZ'[axis]}")

    def add_animation(self, animation, ways, layer):
        kind = self.draw.pick("keys", "linear", ["cubic", "constant"], 0.3)
        short = self.draw.yes("constant curves left out", 0.5)
        by_node = {}
        for track in animation.tracks:
            by_node.setdefault(id(track.node), (track.node, {}))[1][track.path] = track
        for node, tracks in by_node.values():
            times = sorted({round(float(t), 9) for track in tracks.values() for t in track.times})
            said = []
            for time in times:
                at = {p: tracks[p].at(time) if p in tracks else getattr(node, p) for p in "trs"}
                said.append(ways[id(node)].said(at["t"], at["r"], at["s"]) + (at["s"],))
            moves = {"Translation": np.array([t for t, _, _ in said]),
                     "Rotation": euler.curve(ways[id(node)].order, [r for _, r, _ in said]),
                     "Scaling": np.array([s for _, _, s in said])}
            for name, values in moves.items():
                still = np.abs(values - values[0]).max() < 1e-9 * (1 + np.abs(values).max())
                if still and (name == "Scaling" or short) and name != "Rotation":
                    t, own = ways[id(node)].said(node.t, node.r, node.s)
                    base = {"Translation": t, "Scaling": node.s}[name]
                    if np.allclose(base, values[0], atol=1e-9):
                        continue
                group = self.new()
                self.objects.append(Record(
                    "AnimationCurveNode", Long(group), name_and_kind(name[0], "AnimCurveNode", self.binary), "", inside=[
                        Record("Properties70", inside=[property_of(f"d|{a}", "Number", "", "A", float(values[0][k]))
                                                       for k, a in enumerate("XYZ")])]))
                self.link(group, layer)
                self.link(group, self.number[id(node)], f"Lcl {name}")
                for axis in range(3):
                    one = values[:, axis]
                    if short and np.abs(one - one[0]).max() < 1e-12 * (1 + abs(one[0])):
                        continue  # the curve node's own value holds
                    self.add_curve(group, one, times, name, axis, kind)


def settings(scene, unit):
    up = UP[scene.up_name]
    values = []
    for name, way in (("UpAxis", up[:, 1]), ("FrontAxis", up[:, 2]), ("CoordAxis", up[:, 0])):
        axis = int(np.argmax(np.abs(way)))
        values += [property_of(name, "int", "Integer", "", axis),
                   property_of(name + "Sign", "int", "Integer", "", int(np.sign(way[axis])))]
    values += [property_of("UnitScaleFactor", "double", "Number", "", float(unit * 100)),
               property_of("OriginalUnitScaleFactor", "double", "Number", "", 1.0),
               property_of("TimeMode", "enum", "", "", 6),
               property_of("TimeSpanStart", "KTime", "Time", "", Long(0)),
               property_of("TimeSpanStop", "KTime", "Time", "", Long(SECOND))]
    return Record("GlobalSettings", inside=[Record("Version", 1000), Record("Properties70", inside=values)])


def prepare_meshes(scene, draw):
    where = draw.pick("mesh node", None, ["turned", "scaled", "moved", "mirrored"], 0.35)
    geometric = draw.pick("geometric transform", None, ["moved", "turned", "scaled", "all"], 0.3)
    rng = draw.rng("mesh node values")
    for mesh in scene.meshes:
        node = mesh.node
        if where == "turned":
            node.r = np.array([-np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
        elif where == "scaled":
            node.s = np.full(3, rng.choice([100, 0.01, 2.54]))
        elif where == "moved":
            node.t = np.array([rng.uniform(-1, 1) for _ in range(3)]) / scene.unit
        elif where == "mirrored":
            node.s = np.array([-1.0, 1, 1])
        t, degrees, s = np.zeros(3), np.zeros(3), np.ones(3)
        if geometric in ("moved", "all"):
            t = np.array([rng.uniform(-1, 1) for _ in range(3)]) / scene.unit
        if geometric in ("turned", "all"):
            degrees = np.array([rng.choice([90, -90, rng.uniform(-180, 180)]) for _ in range(3)])
        if geometric in ("scaled", "all"):
            s = np.array(rng.choice([(2, 2, 2), (0.01, 0.01, 0.01), (1, 2, 3)]), float)
        mesh.offset = np.eye(4)
        mesh.offset[:3, :3] = euler.matrix("xyz", degrees) * s
        mesh.offset[:3, 3] = t
        mesh.geometric = []
        if geometric:
            mesh.geometric = [vector("GeometricTranslation", t), vector("GeometricRotation", degrees),
                              vector("GeometricScaling", s)]


def write(scene, folder, draw):
    unit = scene.unit
    if draw.yes("scale in the nodes", 0.25):
        # As Blender does: the file says another unit, and nodes above all scale to it.
        factor = draw.rng("scale in the nodes value").choice([100, 0.01, 10])
        node = Node("Scale", None, s=(factor, factor, factor))
        for root in [n for n in scene.nodes if n.parent is None]:
            root.parent = node
        scene.nodes.append(node)
        unit = scene.unit / factor
    prepare_meshes(scene, draw)
    ways = ways_of(scene, draw)
    for node in scene.nodes:
        ways.setdefault(id(node), NodeTransform())
    worlds = scene.worlds()
    # At bind time the mesh's node stands where it stands at rest, or somewhere else.
    for mesh in scene.meshes:
        mesh.bind = worlds[id(mesh.node)] if not draw.yes("node left its bind place", 0.15) else np.eye(4)
        # The links' space is the world, as the root joint has it.
        bound = [k for k, j in enumerate(mesh.skin.joints) if j.role == "Hips"] or [0]
        outer = worlds[id(mesh.skin.joints[bound[0]])] @ mesh.skin.inverse_binds[bound[0]]
        mesh.positions = mesh.positions @ outer[:3, :3].T + outer[:3, 3]
        if np.linalg.det(outer[:3, :3]) < 0:
            mesh.triangles = mesh.triangles[:, ::-1]
        back = np.linalg.inv(outer)
        mesh.skin = type(mesh.skin)(mesh.skin.joints, [b @ back for b in mesh.skin.inverse_binds])
    writer = Writer(scene, draw)
    writer.add_nodes(ways)
    for mesh in scene.meshes:
        writer.add_mesh(mesh)
    for animation in scene.animations:
        stack, layer = writer.new(), writer.new()
        writer.objects.append(Record(
            "AnimationStack", Long(stack), name_and_kind(animation.name, "AnimStack", writer.binary), "", inside=[
                Record("Properties70", inside=[
                    property_of("LocalStop", "KTime", "Time", "", Long(round(24 / 30 * SECOND)))])]))
        writer.objects.append(Record("AnimationLayer", Long(layer), name_and_kind("Base", "AnimLayer", writer.binary), ""))
        writer.link(layer, stack)
        writer.add_animation(animation, ways, layer)
    if draw.yes("objects shuffled", 0.2):
        draw.rng("objects shuffled order").shuffle(writer.objects)
    records = [Record("FBXHeaderExtension", inside=[Record("FBXHeaderVersion", 1003), Record("FBXVersion", 7400),
                                                    Record("Creator", "fuzz")]),
               settings(scene, unit), Record("Definitions", inside=[Record("Version", 100)]),
               Record("Objects", inside=writer.objects), Record("Connections", inside=writer.links)]
    path = folder / "man.fbx"
    if writer.binary:
        out = b"Kaydara FBX Binary  \0\x1a\0" + struct.pack("<I", 7400)
        packed = draw.yes("arrays packed", 0.5)
        for record in records:
            out += bytes_of(record, len(out), packed)
        out += b"\0" * 13 + b"\xfa\xbc\xab\x09\xd0\xc8\xd4\x66\xb1\x76\xfb\x83\x1c\xf7\x26\x7e" + b"\0" * 4
        out += b"\0" * (-len(out) % 16) + struct.pack("<I", 7400) + b"\0" * 120
        out += b"\xf8\x5a\x8c\x6a\xde\xf5\xd9\x7e\xec\xe9\x0c\xe3\x75\x8f\x29\x0b"
        path.write_bytes(out)
    else:
        digits = draw.pick("digits", 9, [7, 17], 0.3)
        text = "; FBX 7.4.0 project file\n; ----------------\n\n" + "".join(text_of(r, 0, digits) + "\n" for r in records)
        if draw.yes("crlf", 0.2):
            text = text.replace("\n", "\r\n")
        path.write_bytes(text.encode())
    return path


def main():
    """write_fbx.py FOLDER SEED...: the box man, as run.py draws him with these seeds."""
    import pathlib
    import sys

    import man
    from draw import Draw
    from vary import vary
    folder = pathlib.Path(sys.argv[1])
    for seed in sys.argv[2:]:
        draw, scene = Draw(int(seed), (), None), man.man()
        vary(scene, draw, FORM)
        write(scene, folder, draw).rename(folder / f"man_{seed}.fbx")


if __name__ == "__main__":
    main()
