# SPDX-License-Identifier: GPL-3.0-or-later
"""The man's motion as a BVH recording, for the character that glTF holds."""
import numpy as np

import euler
import man
from names import SCHEMES
from scene import quat_matrix
from vary import UP

ORDERS = ["zxy", "xyz", "xzy", "yxz", "yzx", "zyx"]  # as a file lists them: the last is turned first


def names_of(draw):
    scheme = draw.pick("names", "plain", [s for s in SCHEMES if s not in ("plain", "one name")], 0.3)
    words = dict(SCHEMES[scheme])
    if scheme == "plain" and draw.yes("spaces in names", 0.2):
        words = {role: role.replace("Left", "Left ").replace("Right", "Right ") for role in words}
    return words


def write(scene, folder, draw):
    animation = scene.animations[0]
    words = names_of(draw)
    unit = draw.pick("unit", 100.0, [1.0, 39.3701, 1000.0, 17.3], 0.5)  # units a metre
    up = UP[draw.pick("up axis", "y", ["z"], 0.2)]
    order = draw.pick("channel order", "zxy", ORDERS[1:], 0.5)
    mixed = draw.yes("an order for each joint", 0.15)
    positions = draw.pick("position channels", "root", ["all", "some", "after rotations"], 0.3)
    digits = draw.pick("digits", 6, [4, 5, 9], 0.3)
    at_zero = draw.yes("root offset 0", 0.5)
    rng = draw.rng("bvh values")
    joints = [n for n in scene.nodes if n.role]
    times = np.arange(man.FRAMES) / man.FPS
    tracks = {(id(t.node), t.path): t for t in animation.tracks}
    lines, columns = [], []

    def number(v):
        return f"{v:.{digits}f}" if not scientific or abs(v) < 1e-3 else f"{v:.{digits}e}"

    scientific = draw.yes("exponents", 0.1)

    def joint(node, depth):
        pad = indent * depth
        children = [n for n in joints if n.parent is node]
        if draw.yes("children turned round", 0.2):
            children.reverse()
        root = node.parent is None
        own = rng.choice(ORDERS) if mixed else order
        offset = up @ node.t * unit
        lines.append(f"{pad}{'ROOT' if root else 'JOINT'} {words[node.role]}")
        lines.append(pad + "{")
        shown = np.zeros(3) if root and at_zero else offset
        lines.append(f"{pad}{indent}OFFSET " + " ".join(number(v) for v in shown))
        has = root or positions == "all" or (positions == "some" and rng.random() < 0.4)
        turns = [f"{a.upper()}rotation" for a in own]
        moves = [f"{a}position" for a in ("XYZ" if not has or rng.random() < 0.7 else "ZYX")] if has else []
        channels = turns + moves if positions == "after rotations" else moves + turns
        lines.append(f"{pad}{indent}CHANNELS {len(channels)} " + " ".join(channels))
        r, t = tracks.get((id(node), "r")), tracks.get((id(node), "t"))
        matrices = [up @ quat_matrix(r.at(x) if r else node.r) @ up.T for x in times]
        angles = euler.curve(own[::-1], matrices)
        places = np.array([up @ (t.at(x) if t else node.t) * unit for x in times])
        for c in channels:
            axis = "XYZ".index(c[0])
            columns.append(angles[:, axis] if c.endswith("rotation") else places[:, axis])
        for child in children:
            joint(child, depth + 1)
        if not children:
            end = {"Head": (0, 0.22, 0), "LeftHand": (0.18, 0, 0), "RightHand": (-0.18, 0, 0)}
            lines.extend([f"{pad}{indent}End Site", pad + indent + "{",
                          f"{pad}{2 * indent}OFFSET " + " ".join(
                              number(v) for v in up @ np.array(end.get(node.role, (0, -0.09, 0.1))) * unit),
                          pad + indent + "}"])
        lines.append(pad + "}")

    indent = draw.pick("indent", "\t", ["  ", ""], 0.3)
    lines.append("HIERARCHY")
    joint(joints[0], 0)
    lines.append("MOTION")
    lines.append(draw.pick("frames line", "Frames: {}", ["Frames:\t{}", "Frames:    {}"], 0.2).format(man.FRAMES))
    step = draw.pick("frame time", "0.0333333", ["0.033333", ".0333333", "0.03333", "0.033333333333", "3.33333e-02"],
                     0.4)
    lines.append(f"Frame Time: {step}")
    for row in np.array(columns).T:
        between = "\t" if indent == "" else " "
        lines.append(between.join(number(v) for v in row) + (" " if draw.rng("space at the end").random() < 0.3 else ""))
    end = draw.pick("line ends", "\n", ["\r\n"], 0.25)
    text = end.join(lines) + draw.pick("end of file", end, ["", end * 3], 0.3)
    path = folder / "man.bvh"
    path.write_bytes((b"\xef\xbb\xbf" if draw.yes("byte order mark", 0.15) else b"") + text.encode())
    return path
