# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene as Ogre XML: man.mesh.xml, and beside it its skeleton with the motion.

Ogre keeps one skeleton at its bind pose, and keys are changes from it: keyed = bind * key.
"""
from xml.sax.saxutils import quoteattr

import numpy as np

from scene import quat_inverse, quat_times

FORM = {"several meshes"}


def vector(tag, v, names="xyz"):
    return f"<{tag} " + " ".join(f'{n}="{x:.9g}"' for n, x in zip(names, v)) + "/>"


def turn(tag, q, draw):
    angle = 2 * np.arctan2(np.linalg.norm(q[:3]), q[3])
    axis = q[:3] / np.linalg.norm(q[:3]) if np.linalg.norm(q[:3]) > 1e-12 else np.array([1.0, 0, 0])
    return f'<{tag} angle="{angle:.9g}">{vector("axis", axis)}</{tag}>'


def write(scene, folder, draw):
    names, number = {}, {}
    needed = set()  # joints and all above them: a skeleton has bones alone
    for node in scene.nodes:
        if node.role or any(node in s.joints for s in scene.skins):
            while node is not None:
                needed.add(id(node))
                node = node.parent
    nodes = [n for n in scene.ordered() if id(n) in needed]
    for k, node in enumerate(nodes):
        number[id(node)] = k
        names[id(node)] = node.name
    shared = draw.yes("shared geometry", 0.5) and all(m.skin is scene.meshes[0].skin for m in scene.meshes)
    per = draw.yes("a buffer for each element", 0.3)
    normals = draw.yes("normals", 0.4)

    def geometry(tag, positions):
        out = f'<{tag} vertexcount="{len(positions)}">'
        normal = '<normal x="0" y="0" z="1"/>' if normals else ""
        if per and normals:
            out += '<vertexbuffer positions="true">' + "".join(f'<vertex>{vector("position", p)}</vertex>' for p in positions)
            out += '</vertexbuffer><vertexbuffer normals="true">' + f"<vertex>{normal}</vertex>" * len(positions)
        else:
            out += f'<vertexbuffer positions="true" normals="{str(normals).lower()}">'
            out += "".join(f'<vertex>{vector("position", p)}{normal}</vertex>' for p in positions)
        return out + f"</vertexbuffer></{tag}>\n"

    def assignments(mesh, first):
        out = "<boneassignments>"
        for v in range(len(mesh.positions)):
            for b, w in zip(mesh.bones[v], mesh.weights[v]):
                if w > 0:
                    out += (f'<vertexboneassignment vertexindex="{v + first}" '
                            f'boneindex="{number[id(mesh.skin.joints[b])]}" weight="{w:.7g}"/>')
        return out

    text = "<mesh>\n"
    if shared:
        text += geometry("sharedgeometry", np.vstack([m.positions for m in scene.meshes]))
    text += "<submeshes>\n"
    first = 0
    for mesh in scene.meshes:
        wide = draw.yes("32 bit indices", 0.3)
        text += (f'<submesh material="m" usesharedvertices="{str(shared).lower()}" '
                 f'use32bitindexes="{str(wide).lower()}" operationtype="triangle_list">')
        faces = mesh.triangles + (first if shared else 0)
        text += f'<faces count="{len(faces)}">' + "".join(
            f'<face v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces) + "</faces>\n"
        if not shared:
            text += geometry("geometry", mesh.positions) + assignments(mesh, 0) + "</boneassignments>\n"
        text += "</submesh>\n"
        first += len(mesh.positions)
    text += "</submeshes>\n<skeletonlink name=\"man.skeleton\"/>\n"
    if shared:
        first, together = 0, ""
        for mesh in scene.meshes:
            together += assignments(mesh, first).replace("<boneassignments>", "")
            first += len(mesh.positions)
        text += f"<boneassignments>{together}</boneassignments>\n"
    text += "</mesh>\n"
    (folder / "man.mesh.xml").write_text(text, encoding="utf-8")

    bones = parents = tracks = ""
    for node in nodes:
        bones += (f'<bone id="{number[id(node)]}" name={quoteattr(names[id(node)])}>{vector("position", node.t)}'
                  f'{turn("rotation", node.r, draw)}' +
                  (vector("scale", node.s) if not np.allclose(node.s, 1) else "") + "</bone>\n")
        if node.parent is not None:
            parents += f'<boneparent bone={quoteattr(names[id(node)])} parent={quoteattr(names[id(node.parent)])}/>\n'
    animation = scene.animations[0]
    by_node = {}
    for track in animation.tracks:
        by_node.setdefault(id(track.node), (track.node, {}))[1][track.path] = track
    length = max(t.times[-1] for t in animation.tracks)
    for node, paths in by_node.values():
        times = sorted({round(float(t), 9) for track in paths.values() for t in track.times})
        tracks += f"<track bone={quoteattr(names[id(node)])}><keyframes>"
        for time in times:
            t = paths["t"].at(time) if "t" in paths else node.t
            r = paths["r"].at(time) if "r" in paths else node.r
            tracks += (f'<keyframe time="{time:.7g}">{vector("translate", t - node.t)}'
                       f'{turn("rotate", quat_times(quat_inverse(node.r), r), draw)}</keyframe>')
        tracks += "</keyframes></track>\n"
    text = (f"<skeleton>\n<bones>\n{bones}</bones>\n<bonehierarchy>\n{parents}</bonehierarchy>\n<animations>\n"
            f'<animation name="{animation.name}" length="{length:.7g}"><tracks>\n{tracks}</tracks></animation>\n'
            "</animations>\n</skeleton>\n")
    (folder / "man.skeleton.xml").write_text(text, encoding="utf-8")
    scene.height_factor = 1 / scene.unit
    return folder / "man.mesh.xml"
