# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene as DirectX .x text. Its space is left-handed, so the scene is mirrored in z; matrices are rows of row vectors."""
import numpy as np

from scene import trs

FORM = {"several meshes", "joint axes", "node above", "rest", "mesh space", "sparse"}
MIRROR = np.diag([1.0, 1, -1, 1])


def numbers(values):
    return ",".join(f"{float(v):.6f}" for v in np.asarray(values).reshape(-1))


def mirrored(m):
    return MIRROR @ m @ MIRROR


def write(scene, folder, draw):
    names, seen = {}, set()
    for k, node in enumerate(scene.nodes):
        name = "".join(c if c.isalnum() or c in "_-" else "_" for c in node.name)
        if name in seen or not name:
            name += f"_{k}"
        seen.add(name)
        names[id(node)] = name
    indent = draw.pick("indent", " ", ["", "\t"], 0.4)
    unused = draw.yes("weights of unused joints", 0.2)
    lines = []

    def out(depth, text):
        lines.append(indent * depth + text)

    def write_mesh(mesh, depth):
        p = mesh.positions * [1, 1, -1]
        out(depth, f"Mesh {mesh.name.replace(' ', '_')} {{")
        out(depth, f"{len(p)};")
        out(depth, ",\n".join(";".join(f"{x:.6f}" for x in v) + ";" for v in p) + ";")
        # The mirror turns triangles round, and a front face of .x is clockwise: both together leave the order.
        corners = mesh.triangles
        out(depth, f"{len(corners)};")
        out(depth, ",\n".join(f"3;{a},{b},{c};" for a, b, c in corners) + ";")
        if draw.yes("normals", 0.3):
            out(depth, "MeshNormals {\n1;\n0.0;0.0;-1.0;;")
            out(depth, f"{len(corners)};\n" + ",\n".join("3;0,0,0;" for _ in corners) + ";\n}")
        rows = [(k, np.nonzero(np.where(mesh.bones == k, mesh.weights, 0).sum(1))[0]) for k in range(len(mesh.skin.joints))]
        rows = [(k, r) for k, r in rows if len(r)]
        out(depth, f"XSkinMeshHeader {{\n{mesh.bones.shape[1]};\n{mesh.bones.shape[1] * 3};\n{len(rows)};\n}}")
        for k, r in rows:
            weight = np.where(mesh.bones == k, mesh.weights, 0).sum(1)[r]
            out(depth, f'SkinWeights {{\n"{names[id(mesh.skin.joints[k])]}";\n{len(r)};')
            out(depth, ",\n".join(map(str, r)) + ";")
            out(depth, ",\n".join(f"{w:.6f}" for w in weight) + ";")
            out(depth, numbers(mirrored(mesh.skin.inverse_binds[k]).T) + ";;\n}")
        out(depth, "}")

    def write_node(node, depth):
        out(depth, f"Frame {names[id(node)]} {{")
        out(depth + 1, f"FrameTransformMatrix {{\n{numbers(mirrored(node.local()).T)};;\n}}")
        for child in scene.nodes:
            if child.parent is node:
                write_node(child, depth + 1)
        for mesh in scene.meshes:
            if mesh.node is node:
                write_mesh(mesh, depth + 1)
        out(depth, "}")

    roots = [n for n in scene.nodes if n.parent is None]
    one_root = draw.yes("a frame above all", 0.5)
    if one_root:
        out(0, f"Frame Scene {{\nFrameTransformMatrix {{\n{numbers(np.eye(4))};;\n}}")
    for root in roots:
        write_node(root, int(one_root))
    if one_root:
        out(0, "}")
    ticks = draw.pick("ticks a second", 4800, [30, 1000, 3000], 0.5)
    if ticks != 4800 or draw.rng("ticks said").random() < 0.5:
        out(0, f"AnimTicksPerSecond {{\n{ticks};\n}}")
    by_matrix = draw.yes("matrix keys", 0.5)
    animation = scene.animations[0]
    out(0, f"AnimationSet {animation.name} {{")
    by_node = {}
    for track in animation.tracks:
        by_node.setdefault(id(track.node), (track.node, {}))[1][track.path] = track
    for node, paths in by_node.values():
        times = sorted({round(float(t), 9) for track in paths.values() for t in track.times})
        if by_matrix:
            # Between matrices some readers turn, some blend: a key for each frame says the same to all.
            times = [k / 30 for k in range(25)]
        at = [[paths[p].at(t) if p in paths else getattr(node, p) for p in "trs"] for t in times]
        out(1, f"Animation {{\n{{{names[id(node)]}}}")
        stamps = [round(t * ticks) for t in times]
        if by_matrix:
            keys = [numbers(mirrored(trs(*posed)).T) for posed in at]
            out(1, f"AnimationKey {{\n4;\n{len(keys)};")
            out(1, ",\n".join(f"{s};16;{k};;" for s, k in zip(stamps, keys)) + ";\n}")
        else:
            # Quaternions are w, x, y, z; the mirror in z turns x and y of the axis round, and .x turns the other way.
            turns = [f"{r[3]:.6f},{r[0]:.6f},{r[1]:.6f},{-r[2]:.6f}" for _, r, _ in at]
            for kind, width, keys in ((0, 4, turns), (1, 3, [numbers(s) for _, _, s in at]),
                                      (2, 3, [numbers(t * [1, 1, -1]) for t, _, _ in at])):
                out(1, f"AnimationKey {{\n{kind};\n{len(keys)};")
                out(1, ",\n".join(f"{s};{width};{k};;" for s, k in zip(stamps, keys)) + ";\n}")
        out(1, "}")
    out(0, "}")
    text = "xof 0303txt 0032\n" + "\n".join(lines) + "\n"
    if draw.yes("crlf", 0.3):
        text = text.replace("\n", "\r\n")
    scene.height_factor = 1 / scene.unit
    path = folder / "man.x"
    path.write_text(text, encoding="utf-8", newline="")
    return path
