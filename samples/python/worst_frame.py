#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Finds the frame of a clip in which the character is deepest in itself, and pushes it out by gradient descent.

    worst_frame.py human.sphc human.glb -o pictures
"""

import argparse
from pathlib import Path

import numpy as np
import spherechain

from draw import render, write_curves, write_png
from glb import Character

FPS = 30
MOST_TURN = np.radians(4)  # of a joint in one step


def skinning_matrices(world, nodes, inverse_binds):
    """(..., bones, 3, 4): each bone's world matrix times its inverse bind matrix."""
    return np.ascontiguousarray((world[..., nodes, :, :] @ inverse_binds)[..., :3, :], np.float32)


def turns(character, world, nodes, inverse_binds, gradient):
    """The gradient by a turn of each node about its own origin, in the world's axes: (nodes, 3).

    A turn w of a node moves the matrix W of each node below by w x (W - origin). So what a loss gains by it is a torque:
    the sum of W's columns crossed with the loss' slopes by them.
    """
    slopes = np.zeros((len(world), 3, 4))
    np.add.at(slopes, nodes, gradient @ inverse_binds.transpose(0, 2, 1))
    torque = np.cross(world[:, :3], slopes, axis=1).sum(2)
    force = slopes[:, :, 3].copy()
    for node in reversed(character.order):
        if character.parents[node] >= 0:
            torque[character.parents[node]] += torque[node]
            force[character.parents[node]] += force[node]
    return torque - np.cross(world[:, :3, 3], force)


def rotation(vector):
    angle = np.linalg.norm(vector)
    x, y, z = vector / max(angle, 1e-12)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def push_out(model, character, local, nodes, inverse_binds, most_steps=60):
    """Turns joints until no fault is left. Returns the pose, and the depth in mm after each step."""
    local, depths = local.copy(), []
    for _ in range(most_steps):
        world = character.world(local)
        bones = skinning_matrices(world, nodes, inverse_binds)
        depths.append(model.penetrations(bones).depth_mm)
        energy, gradient = model.skin_energy(bones)
        if energy == 0:
            break
        slopes = turns(character, world, nodes, inverse_binds, gradient)
        # The energy is squared depth: this step brings a single contact a little further than to zero.
        step = 2.2 * energy / np.square(slopes).sum()
        step = min(step, MOST_TURN / np.linalg.norm(slopes, axis=1).max())
        for node, slope in enumerate(slopes):
            above = world[character.parents[node], :3, :3] if character.parents[node] >= 0 else np.eye(3)
            local[node, :3, :3] = np.linalg.inv(above) @ rotation(-step * slope) @ above @ local[node, :3, :3]
    return local, depths


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("asset")
    parser.add_argument("clip", help="rigged .glb with a clip")
    parser.add_argument("-o", "--output", type=Path, default=Path("."), help="folder for the pictures")
    arguments = parser.parse_args()
    model, character = spherechain.Model(arguments.asset), Character(arguments.clip)
    nodes = [character.names.index(bone.name) for bone in model.bones]
    inverse_binds = np.stack([np.vstack([bone.inverse_bind, [0, 0, 0, 1]]) for bone in model.bones])

    # The whole clip at once, by all cores.
    clip = character.clip(FPS)
    world = character.world(clip)
    faults = model.penetrations(skinning_matrices(world, nodes, inverse_binds), threads=0)
    depths = [frame.depth_mm for frame in faults]
    worst = int(np.argmax(depths))
    if depths[worst] == 0:
        raise SystemExit(f"{len(clip)} frames, no fault")
    deepest = max(faults[worst], key=lambda fault: fault.depth)
    print(f"{len(clip)} frames, faults in {np.count_nonzero(depths)}")
    print(f"worst: frame {worst}, {deepest.part} in {deepest.other}, {deepest.depth_mm:.0f} mm deep")

    after, path = push_out(model, character, clip[worst], nodes, inverse_binds)
    print(f"pushed out in {len(path) - 1} steps: {' '.join(f'{depth:.0f}' for depth in path)} mm")
    linear = after[:, :3, :3] @ np.linalg.inv(clip[worst, :, :3, :3])
    angles = np.degrees(np.arccos(np.clip((np.trace(linear, axis1=1, axis2=2) - 1) / 2, -1, 1)))
    print("turned: " + ", ".join(f"{character.names[i]} {angles[i]:.0f}" for i in np.argsort(-angles)[:4]) + " degrees")

    arguments.output.mkdir(parents=True, exist_ok=True)
    write_curves(arguments.output / "depth.svg", {"deepest fault, mm": ("#c33", depths)}, FPS, worst)
    draw_both(arguments.output / "worst.png", model, character, deepest, world[worst], character.world(after))


def draw_both(path, model, character, contact, before, after):
    """Side by side, from the front and a little from the side; the two body parts in red and blue."""
    names = [model.parts[i].name for i in range(len(model.parts))]
    part_of_bone = {model.bones[part.bone].name: name for part, name in zip(model.parts, names) if part.bone is not None}
    most = character.joints[np.arange(len(character.joints)), character.weights.argmax(1)]
    part_of_joint = [part_of_bone.get(character.names[node], "") for node in character.skin_nodes]
    palette = {contact.part: (0.9, 0.3, 0.25), contact.other: (0.25, 0.45, 0.9)}
    colors = np.array([palette.get(name, (0.8, 0.78, 0.75)) for name in part_of_joint])[most[character.triangles[:, 0]]]
    left, up, forward = map(np.array, (model.left, model.up, model.forward))
    eye = 0.87 * forward + 0.5 * left
    axes = [np.cross(up, eye), up, eye]
    images = [render(character.skinned(pose), character.triangles, colors, contact.point, axes, 0.55 * model.height, 480)
              for pose in (before, after)]
    write_png(path, np.concatenate(images, 1))


main()
