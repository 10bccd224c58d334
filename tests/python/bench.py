#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The loss of the usual sphere proxy, forward and backward on the CPU: this package beside numpy and torch.

    PYTHONPATH=<build>/python tests/python/bench.py ASSET

The loss: spheres of fixed radii follow the bones by linear blend skinning; each pair that overlaps costs the square of its
overlap. numpy and torch do it as people write it: all distances of a pose as one matrix product. Results are compared
first. Contestants take turns; medians. Memory is the growth of a fresh process' peak, its libraries loaded.

To make an asset with 192 spheres: echo '{"penetration_depth": 0.765}' > many.json, and
spherechain bake /usr/share/assimp/models/Collada/human.zae --config many.json -o many.sphc
"""

import argparse
import re
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import spherechain
from palettes import random_poses

try:
    import torch
except ImportError:
    torch = None


class Proxy:
    """The spheres, their radii and their pairs, for all who compute the loss."""

    def __init__(self, model):
        count, bones = model.sphere_count, len(model.bones)
        # Centres are linear in the matrices. Their coefficients are the slopes of each sphere's x by the first rows.
        one = np.zeros((count, count, 4))
        one[range(count), range(count), 0] = 1
        pose = np.tile(np.eye(3, 4), (count, bones, 1, 1))
        self.terms = model.spheres_vjp(pose, one)[:, :, 0].reshape(count, bones * 4).T.astype(np.float32).copy()
        self.radii = model.rest_spheres[:, 3].copy()
        self.reach = model.pair_scales() * (self.radii[:, None] + self.radii)


def by_numpy(proxy, bones):
    count = len(bones)
    rows = bones.transpose(0, 2, 1, 3).reshape(count * 3, -1)
    centers = (rows @ proxy.terms).reshape(count, 3, -1)
    squares = (centers * centers).sum(1)
    squared = squares[:, :, None] + squares[:, None] - 2 * centers.transpose(0, 2, 1) @ centers
    distances = np.sqrt(np.maximum(squared, 1e-12))
    overlaps = np.maximum(proxy.reach - distances, 0)
    energy = (overlaps * overlaps).sum((1, 2)) / 2
    slopes = -2 * overlaps / distances
    gradient = centers * slopes.sum(2)[:, None] - centers @ slopes
    return energy, (gradient.reshape(count * 3, -1) @ proxy.terms.T).reshape(count, 3, -1, 4).transpose(0, 2, 1, 3)


def by_torch(proxy, bones):
    bones = torch.from_numpy(bones).requires_grad_()
    rows = bones.permute(0, 2, 1, 3).reshape(len(bones) * 3, -1)
    centers = (rows @ torch.from_numpy(proxy.terms)).reshape(len(bones), 3, -1).transpose(1, 2)
    overlaps = torch.relu(torch.from_numpy(proxy.reach) - torch.cdist(centers, centers))
    energy = overlaps.square().sum((1, 2)) / 2
    energy.sum().backward()
    return energy.detach().numpy(), bones.grad.numpy()


def by_spherechain(model, proxy, threads):
    def run(bones):
        spheres = model.spheres(bones, threads=threads)
        spheres[..., 3] = proxy.radii
        energy, slopes = model.pair_energy(spheres, threads=threads)
        slopes[..., 3] = 0
        return energy, model.spheres_vjp(bones, slopes, threads=threads)
    return run


def contestants(model):
    proxy = Proxy(model)
    out = {"numpy": lambda bones: by_numpy(proxy, bones)}
    if torch is not None:
        out["torch"] = lambda bones: by_torch(proxy, bones)
    out["spherechain, 1 thread"] = by_spherechain(model, proxy, 1)
    out["spherechain, all cores"] = by_spherechain(model, proxy, 0)
    out["radii follow the bones, 1 thread"] = lambda bones: model.sphere_energy(bones)
    out["radii follow the bones, all cores"] = lambda bones: model.sphere_energy(bones, threads=0)
    return out


def check(runs, bones):
    energy, gradient = runs["numpy"](bones)
    for name, run in runs.items():
        if name.startswith("radii"):
            continue
        other, other_gradient = run(bones)
        off = np.abs(other - energy).max() / energy.max()
        gradient_off = np.abs(other_gradient - gradient).max() / np.abs(gradient).max()
        if max(off, gradient_off) > 1e-3:
            raise SystemExit(f"{name} has other results: {off:.1e}, gradient {gradient_off:.1e}")


def memory_mb(key):
    status = Path("/proc/self/status").read_text()
    return int(re.search(rf"{key}:\s+(\d+) kB", status)[1]) / 1024


def memory(arguments, name):
    child = [sys.executable, __file__, arguments.asset, "--batch", str(arguments.batch), "--memory", name]
    return float(subprocess.run(child, capture_output=True, text=True, check=True).stdout)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("asset")
    parser.add_argument("--batch", type=int, default=256)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--memory", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    model = spherechain.Model(arguments.asset)
    bones = random_poses(model, arguments.batch)
    runs = contestants(model)
    if arguments.memory:
        runs[arguments.memory](bones[:1])
        before = memory_mb("VmRSS")
        Path("/proc/self/clear_refs").write_text("5")  # the peak starts anew
        runs[arguments.memory](bones)
        print(memory_mb("VmHWM") - before)
        return
    check(runs, bones)
    times = {name: [] for name in runs}
    for turn in range(arguments.rounds + 1):
        for name, run in runs.items():
            start = time.perf_counter()
            run(bones)
            if turn > 0:
                times[name].append(time.perf_counter() - start)
    print(f"{model.sphere_count} spheres on {len(model.bones)} bones, batch {arguments.batch}, loss and gradient")
    print(f"{'':36}{'ms':>8}{'poses/s':>10}{'numpy = 1':>11}{'MB':>7}")
    base = statistics.median(times["numpy"])
    for name, own in times.items():
        median = statistics.median(own)
        print(f"{name:36}{median * 1e3:8.2f}{arguments.batch / median:10.0f}{base / median:11.1f}"
              f"{memory(arguments, name):7.1f}")


main()
