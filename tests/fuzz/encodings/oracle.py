# SPDX-License-Identifier: GPL-3.0-or-later
"""Which body parts of the box man meet in which frames, found without the tool.

Every triangle of a part is tested against every triangle of another by its edges. Contacts that a tenth of a millimetre
decides are `unsure`: either answer about them is right.
"""
import numpy as np

import man

# Parts that hang on each other. The tool leaves contacts of neighbours out; so does the comparison.
CHAIN = [("head", "neck"), ("neck", "chest"), ("chest", "abdomen"), ("abdomen", "hips"), ("head", "chest")]
for side in ("left", "right"):
    CHAIN += [("chest", f"{side} upper arm"), (f"{side} upper arm", f"{side} forearm"),
              (f"{side} forearm", f"{side} hand"), ("hips", f"{side} thigh"), (f"{side} thigh", f"{side} shin"),
              (f"{side} shin", f"{side} foot"), ("neck", f"{side} upper arm"), ("abdomen", f"{side} thigh")]
NEIGHBOURS = {frozenset(pair) for pair in CHAIN} | {frozenset(("left thigh", "right thigh"))}


def edges_through(a, b):
    """Whether an edge of triangle a[i] goes through triangle b[i]: arrays of shape n, 3, 3."""
    hit = np.zeros(len(a), bool)
    e1, e2 = b[:, 1] - b[:, 0], b[:, 2] - b[:, 0]
    for k in range(3):
        start, way = a[:, k], a[:, (k + 1) % 3] - a[:, k]
        h = np.cross(way, e2)
        det = np.einsum("ij,ij->i", e1, h)
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = 1 / det
            s = start - b[:, 0]
            u = np.einsum("ij,ij->i", s, h) * inverse
            q = np.cross(s, e1)
            v = np.einsum("ij,ij->i", way, q) * inverse
            t = np.einsum("ij,ij->i", e2, q) * inverse
            hit |= (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0) & (t <= 1) & (det != 0)
    return hit


def crossing(a, b):
    """Number of pairs of triangles, one of a and one of b, that intersect."""
    low_a, high_a, low_b, high_b = a.min(1), a.max(1), b.min(1), b.max(1)
    low, high = np.maximum(low_a.min(0), low_b.min(0)), np.minimum(high_a.max(0), high_b.max(0))
    if (low > high).any():
        return 0
    keep_a, keep_b = ((low_a <= high) & (high_a >= low)).all(1), ((low_b <= high) & (high_b >= low)).all(1)
    a, b, low_a, high_a, low_b, high_b = a[keep_a], b[keep_b], low_a[keep_a], high_a[keep_a], low_b[keep_b], high_b[keep_b]
    near = np.ones((len(a), len(b)), bool)
    for axis in range(3):
        near &= low_a[:, None, axis] <= high_b[None, :, axis]
        near &= low_b[None, :, axis] <= high_a[:, None, axis]
    i, j = np.nonzero(near)
    return int((edges_through(a[i], b[j]) | edges_through(b[j], a[i])).sum()) if len(i) else 0


def contacts_of(corners, parts):
    """Pairs of parts that intersect -> number of pairs of triangles. `corners` has shape triangles, 3, 3."""
    names = sorted(set(parts))
    of = {name: corners[[p == name for p in parts]] for name in names}
    found = {}
    for i, a in enumerate(names):
        for b in names[i + 1:]:
            count = crossing(of[a], of[b])
            if count:
                found[frozenset((a, b))] = count
    return found


class Truth:
    """What is right about the man's motion: `must[frame]` and `may[frame]` are sets of pairs of parts."""

    def __init__(self):
        scene = man.man()
        self.parts = sorted(set(scene.parts))
        self.height = man.HEIGHT
        mesh = scene.meshes[0]
        jitter = np.random.default_rng(1)
        self.must, self.may, self.counts = [], [], []
        rest = set(contacts_of(scene.skinned()[0][mesh.triangles], scene.parts))
        for frame in range(man.FRAMES):
            p = scene.skinned(scene.animations[0], frame / man.FPS)[0]
            sets = []
            for k in range(4):
                # Files may round places to a fifth of a millimetre, times to half a millisecond.
                near = p if k < 2 else scene.skinned(scene.animations[0], frame / man.FPS + (k - 2.5) * 1e-3)[0]
                moved = near + (jitter.uniform(-2e-4, 2e-4, p.shape) if k else 0)
                sets.append(contacts_of(moved[mesh.triangles], scene.parts))
            self.counts.append(sets[0])
            found = [{pair for pair in s if pair not in NEIGHBOURS and pair not in rest} for s in sets]
            self.must.append(set.intersection(*found))
            self.may.append(set.union(*found))


if __name__ == "__main__":
    truth = Truth()
    for f in range(man.FRAMES):
        print(f, sorted(f"{' + '.join(sorted(p))} {truth.counts[f].get(p)}" for p in truth.must[f]),
              "unsure:", [sorted(p) for p in truth.may[f] - truth.must[f]])
