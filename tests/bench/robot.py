#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""robot.py FOLDER: writes a humanoid-like robot of 30 links and 400,000 triangles as URDF and STL, and a motion as CSV.

Then: spherechain bake FOLDER/robot.urdf -o FOLDER/robot.sphc
      spherechain play FOLDER/robot.sphc --source FOLDER/robot.urdf --motion FOLDER/motion.csv
"""
import math
import pathlib
import struct
import sys

AROUND, ALONG = 116, 59  # a link has 2 * 116 * 58 triangles
LIMBS = [("left_arm", 6, (0, .22, .45), (0, .6, -1)), ("right_arm", 6, (0, -.22, .45), (0, -.6, -1)),
         ("left_leg", 6, (0, .12, -.05), (0, .1, -1)), ("right_leg", 6, (0, -.12, -.05), (0, -.1, -1)),
         ("neck", 2, (0, 0, .5), (0, 0, 1)), ("back", 3, (-.18, 0, .4), (-.4, 0, -1))]


def link(path, length, radius):
    """A rounded rod with ribs from the origin down to -length along z."""
    def point(ring, i):
        along = ring / ALONG
        bulge = math.sqrt(max(0, 1 - (2 * along - 1) ** 8)) * (1 + .04 * math.cos(40 * along))
        angle = 2 * math.pi * i / AROUND
        r = radius * bulge * (1 + .03 * math.cos(8 * angle))
        return r * math.cos(angle), r * math.sin(angle), -length * along
    triangles = []
    for ring in range(ALONG):
        for i in range(AROUND):
            a, b = point(ring, i), point(ring, (i + 1) % AROUND)
            c, d = point(ring + 1, i), point(ring + 1, (i + 1) % AROUND)
            if ring > 0:
                triangles.append((a, c, b))
            if ring < ALONG - 1:
                triangles.append((b, c, d))
    with open(path, "wb") as file:
        file.write(b" " * 80 + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<12fH", 0, 0, 0, *triangle[0], *triangle[1], *triangle[2], 0))
    return len(triangles)


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    triangles = link(folder / "trunk.stl", .55, .17)
    per_link = link(folder / "link.stl", .15, .045)
    mesh = '<visual><geometry><mesh filename="%s.stl"/></geometry></visual>'
    out = ['<robot name="robot">', '<link name="trunk"><visual><origin xyz="0 0 .5"/><geometry>'
           '<mesh filename="trunk.stl"/></geometry></visual></link>']
    joints = []
    for name, count, start, down in LIMBS:
        parent = "trunk"
        for i in range(count):
            own = f"{name}_{i}"
            triangles += per_link
            out.append(f'<link name="{own}">{mesh % "link"}</link>')
            turn = math.atan2(math.hypot(down[0], down[1]), -down[2])
            rpy = (turn if down[1] > 0 else -turn, 0, 0) if abs(down[1]) > 0 else (0, turn, 0)
            xyz = start if i == 0 else (0, 0, -.16)
            out.append(f'<joint name="{own}_joint" type="revolute"><parent link="{parent}"/><child link="{own}"/>'
                       f'<origin xyz="{xyz[0]} {xyz[1]} {xyz[2]}" rpy="{" ".join(map(str, rpy if i == 0 else (0, 0, 0)))}"/>'
                       f'<axis xyz="{i % 2} {(i + 1) % 2} 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>')
            joints.append((own + "_joint", i))
            parent = own
    out.append("</robot>")
    (folder / "robot.urdf").write_text("\n".join(out))
    rows = ["time," + ",".join(name for name, _ in joints)]
    for frame in range(300):
        t = frame / 30
        rows.append(",".join([f"{t:.4f}"] + [f"{.7 * math.sin(t * (1 + .13 * k) + k):.5f}" for k in range(len(joints))]))
    (folder / "motion.csv").write_text("\n".join(rows) + "\n")
    print(len(joints) + 1, "links,", triangles, "triangles")


main()
