# SPDX-License-Identifier: GPL-3.0-or-later
"""The box man: 19 joints, 17 boxes that are apart at rest, and one motion in which he strikes himself.

Metres, y up, he looks along z, his left is x. He stands with his arms spread.
"""
import numpy as np

from scene import Animation, Mesh, Node, Scene, Skin, Track, quat

FPS = 30
FRAMES = 25
HEIGHT = 1.755

# Joint, parent, place at rest.
JOINTS = [
    ("Hips", None, (0, 0.95, 0)), ("Spine", "Hips", (0, 1.05, 0)), ("Chest", "Spine", (0, 1.2, 0)),
    ("Neck", "Chest", (0, 1.45, 0)), ("Head", "Neck", (0, 1.53, 0)),
    ("LeftShoulder", "Chest", (0.06, 1.4, 0)), ("LeftUpperArm", "LeftShoulder", (0.18, 1.4, 0)),
    ("LeftLowerArm", "LeftUpperArm", (0.46, 1.4, 0)), ("LeftHand", "LeftLowerArm", (0.71, 1.4, 0)),
    ("RightShoulder", "Chest", (-0.06, 1.4, 0)), ("RightUpperArm", "RightShoulder", (-0.18, 1.4, 0)),
    ("RightLowerArm", "RightUpperArm", (-0.46, 1.4, 0)), ("RightHand", "RightLowerArm", (-0.71, 1.4, 0)),
    ("LeftUpperLeg", "Hips", (0.1, 0.92, 0)), ("LeftLowerLeg", "LeftUpperLeg", (0.1, 0.5, 0)),
    ("LeftFoot", "LeftLowerLeg", (0.1, 0.09, 0)),
    ("RightUpperLeg", "Hips", (-0.1, 0.92, 0)), ("RightLowerLeg", "RightUpperLeg", (-0.1, 0.5, 0)),
    ("RightFoot", "RightLowerLeg", (-0.1, 0.09, 0)),
]

# Joint that carries the box, name of the body part, corners, cells a side. Boxes on the left are mirrored.
BOXES = [
    ("Hips", "hips", (-0.15, 0.875, -0.09), (0.15, 1.025, 0.09), (4, 2, 3)),
    ("Spine", "abdomen", (-0.13, 1.035, -0.08), (0.13, 1.185, 0.08), (4, 2, 3)),
    ("Chest", "chest", (-0.155, 1.195, -0.1), (0.155, 1.445, 0.1), (5, 4, 3)),
    ("Neck", "neck", (-0.045, 1.45, -0.045), (0.045, 1.52, 0.045), (2, 2, 2)),
    ("Head", "head", (-0.08, 1.525, -0.09), (0.08, 1.755, 0.11), (3, 4, 4)),
    ("UpperArm", "upper arm", (0.185, 1.355, -0.045), (0.455, 1.445, 0.045), (6, 2, 2)),
    ("LowerArm", "forearm", (0.465, 1.362, -0.038), (0.705, 1.438, 0.038), (6, 2, 2)),
    ("Hand", "hand", (0.71, 1.38, -0.045), (0.89, 1.42, 0.045), (5, 2, 3)),
    ("UpperLeg", "thigh", (0.025, 0.505, -0.075), (0.175, 0.885, 0.075), (3, 7, 3)),
    ("LowerLeg", "shin", (0.045, 0.095, -0.055), (0.155, 0.495, 0.055), (2, 7, 2)),
    ("Foot", "foot", (0.05, 0, -0.07), (0.15, 0.09, 0.19), (3, 2, 5)),
]

# How far each joint is turned at the height of the strike, as a rotation vector in degrees.
STRIKE = {
    "LeftUpperArm": (-101.97, 95.42, -46.36), "LeftLowerArm": (0, 23.9, 0),
    "RightUpperArm": (-97.86, -58.74, 82.99), "RightLowerArm": (0, -125.5, 0),
    "LeftUpperLeg": (-12, 0, 0), "RightUpperLeg": (10, 0, 0), "Spine": (0, 6, 0),
}
# Which part of that is done in which frame; between these frames joints turn evenly.
EASE = [(0, 0.0), (4, 0.5), (8, 0.85), (12, 1.0), (17, 0.8), (21, 0.35), (24, 0.0)]
TRAVEL = {0: (0, 0, 0), 12: (0.03, -0.02, 0.12), 24: (0, 0, 0.2)}  # of the hips

SLOPE = 0.05  # metres beside a joint in which its parent moves the skin, too


def box(low, high, cells):
    """A closed box with faces in cells, its edges and corners a little rounded."""
    low, high = np.array(low, float), np.array(high, float)
    n = np.array(cells)
    number, points, triangles = {}, [], []

    def vertex(ijk):
        if ijk not in number:
            u = np.array(ijk) / n * 2 - 1
            faces = int(sum(abs(abs(u)) == 1))
            number[ijk] = len(points)
            points.append((low + high) / 2 + u * (high - low) / 2 * {1: 1.0, 2: 0.94, 3: 0.88}[faces])
        return number[ijk]

    for axis in range(3):
        a, b = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, n[axis]):
            for i in range(n[a]):
                for j in range(n[b]):
                    corner = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        ijk = [0, 0, 0]
                        ijk[axis], ijk[a], ijk[b] = int(side), i + di, j + dj
                        corner.append(vertex(tuple(ijk)))
                    if side == 0:
                        corner.reverse()
                    triangles += [[corner[0], corner[1], corner[2]], [corner[0], corner[2], corner[3]]]
    return np.array(points), np.array(triangles)


def man():
    scene = Scene()
    node = {}
    place = {name: np.array(at, float) for name, _, at in JOINTS}
    for name, parent, at in JOINTS:
        node[name] = Node(name, node.get(parent), place[name] - (place[parent] if parent else 0))
        node[name].role = name
    names = [name for name, _, _ in JOINTS]
    scene.nodes = list(node.values())
    binds = []
    for name in names:
        bind = np.eye(4)
        bind[:3, 3] = -place[name]
        binds.append(bind)
    skin = Skin([node[name] for name in names], binds)
    scene.skins = [skin]

    positions, triangles, bones, weights, parts = [], [], [], [], []
    for carrier, part, low, high, cells in BOXES:
        sides = [""] if carrier in node else ["Left", "Right"]
        for side in sides:
            p, t = box(low, high, cells)
            if side == "Right":
                p, t = p * [-1, 1, 1], t[:, ::-1]
            joint = side + carrier
            above = {n: q for n, q, _ in JOINTS}[joint]
            for v in p:
                # The skin within 5 cm of a joint follows its parent by up to a third.
                away = np.linalg.norm(v - place[joint])
                share = max(0.0, 1 - away / SLOPE) / 3 if above else 0.0
                bones.append([names.index(joint), names.index(above or joint)])
                weights.append([1 - share, share])
            triangles += (t + len(positions)).tolist()
            parts += [((side.lower() + " ") if side else "") + part] * len(t)
            positions += p.tolist()
    body = Node("Body")
    scene.nodes.append(body)
    mesh = Mesh("Body", body, skin, np.array(positions), np.array(bones), np.array(weights), np.array(triangles))
    mesh.origin = np.arange(len(positions))
    scene.meshes = [mesh]
    scene.animations = [motion(node)]
    scene.parts = parts
    return scene


def motion(node):
    tracks = []
    frames = [f for f, _ in EASE]
    for name, peak in STRIKE.items():
        keys = [quat(np.radians(peak) * share) for _, share in EASE]
        dense = Track(node[name], "r", np.array(frames) / FPS, keys)
        times = np.arange(FRAMES) / FPS
        tracks.append(Track(node[name], "r", times, [dense.at(t) for t in times]))
        tracks[-1].corners = frames  # the frames that say the same without the others
    start = node["Hips"].t
    way = Track(node["Hips"], "t", np.array(list(TRAVEL)) / FPS, [start + np.array(v) for v in TRAVEL.values()])
    times = np.arange(FRAMES) / FPS
    tracks.append(Track(node["Hips"], "t", times, [way.at(t) for t in times]))
    tracks[-1].corners = list(TRAVEL)
    return Animation("strike", tracks)
