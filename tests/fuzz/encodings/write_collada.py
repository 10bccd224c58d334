# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene as Collada 1.4.1: controllers with skins, nodes with transforms, animations by matrices or by angles."""
from xml.sax.saxutils import escape, quoteattr

import numpy as np

import euler
from scene import quat_matrix, trs

FORM = {"several meshes", "joint axes", "node above", "rest", "mesh space"}
ORDERS = ["xyz", "xzy", "yzx", "yxz", "zxy", "zyx"]


def numbers(values, digits=9):
    return " ".join(f"{float(v):.{digits}g}" for v in np.asarray(values).reshape(-1))


class Writer:
    def __init__(self, scene, draw):
        self.scene, self.draw = scene, draw
        self.ids = {id(n): f"node{k}" for k, n in enumerate(scene.nodes)}
        if draw.yes("ids are names", 0.4):
            self.ids = {id(n): f"{n.name.replace(' ', '_').replace(':', '_')}_{k}" for k, n in enumerate(scene.nodes)}
        self.by_matrix = draw.yes("matrices", 0.5)
        self.orders = {}
        rng = draw.rng("collada orders")
        for node in scene.nodes:
            self.orders[id(node)] = rng.choice(ORDERS) if draw.yes("rotation orders", 0.3) else "xyz"

    def source(self, name, values, params, kind="float"):
        values = list(values)
        flat = numbers(values) if kind.startswith("float") else " ".join(values)
        tag = "Name_array" if kind.lower() == "name" else "IDREF_array" if kind == "IDREF" else "float_array"
        count = np.asarray(values).size if kind.startswith("float") else len(values)
        stride = {"float4x4": 16}.get(kind, len(params))
        lines = "".join(f'<param name="{p}" type="{kind}"/>' for p in params)
        return (f'<source id="{name}"><{tag} id="{name}-array" count="{count}">{escape(flat)}</{tag}><technique_common>'
                f'<accessor source="#{name}-array" count="{count // stride}" stride="{stride}">{lines}</accessor>'
                f'</technique_common></source>\n')

    def geometry(self, k, mesh):
        name = f"mesh{k}"
        out = f'<geometry id="{name}" name={quoteattr(mesh.name)}><mesh>\n'
        out += self.source(f"{name}-positions", mesh.positions, "XYZ")
        out += f'<vertices id="{name}-vertices"><input semantic="POSITION" source="#{name}-positions"/></vertices>\n'
        corners, stride = mesh.triangles.reshape(-1), 1
        extra = ""
        if self.draw.yes("normals", 0.4):
            out += self.source(f"{name}-normals", np.tile([0, 0, 1.0], (len(mesh.triangles), 1)), "XYZ")
            extra = f'<input semantic="NORMAL" source="#{name}-normals" offset="1"/>'
            corners = np.stack([corners, np.repeat(np.arange(len(mesh.triangles)), 3)], 1).reshape(-1)
        first = f'<input semantic="VERTEX" source="#{name}-vertices" offset="0"/>'
        count = len(mesh.triangles)
        p = f"<p>{' '.join(map(str, corners))}</p>"
        if self.draw.yes("polylist", 0.4):
            out += f'<polylist count="{count}">{first}{extra}<vcount>{" ".join("3" * count)}</vcount>{p}</polylist>'
        else:
            out += f'<triangles count="{count}">{first}{extra}{p}</triangles>'
        return out + "</mesh></geometry>\n"

    def controller(self, k, mesh):
        name, skin = f"skin{k}", mesh.skin
        shape = np.eye(4)
        if self.draw.yes("bind shape matrix", 0.3):
            shape = trs([0.5, -1, 2], [0.5, 0.5, 0.5, 0.5], [2.0, 2, 2])
        binds = skin.inverse_binds
        weights = {}
        vcount, v, values = [], [], []
        for row in range(len(mesh.positions)):
            used = [(int(b), float(w)) for b, w in zip(mesh.bones[row], mesh.weights[row]) if w > 0]
            vcount.append(len(used))
            for b, w in used:
                if w not in weights:
                    weights[w] = len(values)
                    values.append(w)
                v += [b, weights[w]]
        use_ids = self.draw.yes("joints by id", 0.2)
        joints = [self.ids[id(j)] if use_ids else "s" + self.ids[id(j)] for j in skin.joints]
        out = f'<controller id="{name}"><skin source="#mesh{k}"><bind_shape_matrix>{numbers(shape)}</bind_shape_matrix>\n'
        out += self.source(f"{name}-joints", joints, ["JOINT"], "IDREF" if use_ids else "Name")
        out += self.source(f"{name}-binds", [b.reshape(-1) for b in binds], ["TRANSFORM"], "float4x4")
        out += self.source(f"{name}-weights", values, ["WEIGHT"])
        out += (f'<joints><input semantic="JOINT" source="#{name}-joints"/><input semantic="INV_BIND_MATRIX" '
                f'source="#{name}-binds"/></joints>\n<vertex_weights count="{len(vcount)}"><input semantic="JOINT" '
                f'source="#{name}-joints" offset="0"/><input semantic="WEIGHT" source="#{name}-weights" offset="1"/>'
                f'<vcount>{" ".join(map(str, vcount))}</vcount><v>{" ".join(map(str, v))}</v></vertex_weights>'
                f'</skin></controller>\n')
        mesh.shape = shape
        return out

    def transforms(self, node, animated):
        if self.by_matrix or ("s" in animated):
            return f'<matrix sid="transform">{numbers(node.local())}</matrix>'
        order = self.orders[id(node)]
        degrees = euler.angles(order, quat_matrix(node.r))
        turns = ""
        for axis in reversed(order):
            k = "xyz".index(axis)
            way = " ".join("1" if i == k else "0" for i in range(3))
            turns += f'<rotate sid="rotate{axis.upper()}">{way} {degrees[k]:.9g}</rotate>'
        return (f'<translate sid="location">{numbers(node.t)}</translate>{turns}'
                f'<scale sid="scale">{numbers(node.s)}</scale>')

    def node(self, node, animated, depth=1):
        scene, own = self.scene, self.ids[id(node)]
        joints = {id(j) for s in scene.skins for j in s.joints}
        is_joint = node.role or id(node) in joints
        out = f'{"  " * depth}<node id="{own}" name={quoteattr(node.name)} sid="s{own}"' + \
            (' type="JOINT">' if is_joint else ' type="NODE">')
        out += self.transforms(node, animated.get(id(node), set()))
        for k, mesh in enumerate(scene.meshes):
            if mesh.node is node:
                top = mesh.skin.joints[0]
                while top.parent is not None and top.parent.role:
                    top = top.parent
                skeleton = "" if self.draw.yes("no skeleton said", 0.2) else f"<skeleton>#{self.ids[id(top)]}</skeleton>"
                out += f'<instance_controller url="#skin{k}">{skeleton}</instance_controller>'
        out += "\n"
        for child in scene.nodes:
            if child.parent is node:
                out += self.node(child, animated, depth + 1)
        return out + "  " * depth + "</node>\n"

    def channel(self, name, times, values, target, params, kind="float"):
        step = self.draw.pick("interpolation", "LINEAR", ["STEP", "BEZIER"], 0.3)
        out = self.source(f"{name}-in", times, ["TIME"]) + self.source(f"{name}-out", values, params, kind)
        out += self.source(f"{name}-how", [step] * len(times), ["INTERPOLATION"], "name")
        tangents = ""
        if step == "BEZIER" and kind == "float" and len(params) == 1:
            for side in ("in", "out"):
                shift = -1 / 90 if side == "in" else 1 / 90
                out += self.source(f"{name}-{side}t", [(t + shift, v) for t, v in zip(times, values)], ["X", "Y"])
                tangents += f'<input semantic="{side.upper()}_TANGENT" source="#{name}-{side}t"/>'
        return out + (f'<sampler id="{name}-s"><input semantic="INPUT" source="#{name}-in"/><input semantic="OUTPUT" '
                      f'source="#{name}-out"/><input semantic="INTERPOLATION" source="#{name}-how"/>{tangents}</sampler>'
                      f'<channel source="#{name}-s" target="{target}"/>\n')

    def animation(self, animation):
        by_node, out = {}, ""
        for track in animation.tracks:
            by_node.setdefault(id(track.node), (track.node, {}))[1][track.path] = track
        nested = self.draw.yes("one animation for all", 0.3)
        for node, tracks in by_node.values():
            own = self.ids[id(node)]
            times = sorted({round(float(t), 9) for track in tracks.values() for t in track.times})
            posed = [{p: tracks[p].at(t) if p in tracks else getattr(node, p) for p in "trs"} for t in times]
            inside = ""
            if self.by_matrix:
                inside = self.channel(f"{own}-m", times, [trs(p["t"], p["r"], p["s"]).reshape(-1) for p in posed],
                                      f"{own}/transform", ["TRANSFORM"], "float4x4")
            else:
                order = self.orders[id(node)]
                if "r" in tracks:
                    angles = euler.curve(order, [quat_matrix(p["r"]) for p in posed])
                    for k, axis in enumerate("XYZ"):
                        inside += self.channel(f"{own}-{axis}", times, angles[:, k], f"{own}/rotate{axis}.ANGLE", ["ANGLE"])
                if "t" in tracks:
                    if self.draw.yes("a channel for each axis", 0.5):
                        for k, axis in enumerate("XYZ"):
                            inside += self.channel(f"{own}-t{axis}", times, [p["t"][k] for p in posed],
                                                   f"{own}/location.{axis}", [axis])
                    else:
                        inside += self.channel(f"{own}-t", times, [p["t"] for p in posed], f"{own}/location", "XYZ")
            out += inside if nested else f'<animation id="{own}-animation">{inside}</animation>\n'
        return f'<animation id="{animation.name}">{out}</animation>\n' if nested else out


def write(scene, folder, draw):
    writer = Writer(scene, draw)
    animated = {}
    for animation in scene.animations:
        for track in animation.tracks:
            animated.setdefault(id(track.node), set()).add(track.path)
    controllers = "".join(writer.controller(k, m) for k, m in enumerate(scene.meshes))
    # The bind shape takes the geometry to the space of the inverse binds.
    for mesh in scene.meshes:
        back = np.linalg.inv(mesh.shape)
        mesh.positions = mesh.positions @ back[:3, :3].T + back[:3, 3]
    geometries = "".join(writer.geometry(k, m) for k, m in enumerate(scene.meshes))
    unit = scene.unit
    axis = {"y": "Y_UP", "z": "Z_UP", "x": "X_UP"}[scene.up_name]
    roots = "".join(writer.node(n, animated) for n in scene.nodes if n.parent is None)
    text = ('<?xml version="1.0" encoding="utf-8"?>\n<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" '
            f'version="1.4.1"><asset><created>2026-01-01T00:00:00</created><modified>2026-01-01T00:00:00</modified>'
            f'<unit name="own" meter="{unit:.9g}"/><up_axis>{axis}</up_axis></asset>\n'
            f'<library_geometries>{geometries}</library_geometries>\n<library_controllers>{controllers}'
            f'</library_controllers>\n<library_animations>{"".join(map(writer.animation, scene.animations))}'
            f'</library_animations>\n<library_visual_scenes><visual_scene id="scene" name="scene">\n{roots}'
            '</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#scene"/></scene></COLLADA>\n')
    if draw.yes("crlf", 0.1):
        text = text.replace("\n", "\r\n")
    path = folder / "man.dae"
    path.write_bytes((b"\xef\xbb\xbf" if draw.yes("byte order mark", 0.1) else b"") + text.encode())
    return path
