# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes to a scene that leave the character's motion as it is, in any format."""
import numpy as np

from names import SCHEMES, rename
from scene import (Mesh, Node, Skin, Track, matrix_quat, quat, quat_inverse, quat_matrix, quat_times, split_trs, trs)

UP = {"y": np.eye(3), "z": np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0.0]]),
      "x": np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]])}  # from y up


def random_rotation(rng, right_angles=False):
    if right_angles:
        return quat_times(quat(np.pi / 2 * rng.randrange(4) * np.eye(3)[rng.randrange(3)]),
                          quat(np.pi / 2 * rng.randrange(4) * np.eye(3)[rng.randrange(3)]))
    q = np.array([rng.gauss(0, 1) for _ in range(4)])
    return q / np.linalg.norm(q)


def tracks_of(scene, node):
    return [t for a in scene.animations for t in a.tracks if t.node is node]


def reexpress(scene, rotation, factor):
    """The scene in other axes and units: every point p becomes factor * rotation * p. Axes are exchanged, not tilted."""
    q = matrix_quat(rotation)

    def turned(r):
        return quat_times(quat_times(q, r), quat_inverse(q))

    for node in scene.nodes:
        node.t, node.r, node.s = factor * rotation @ node.t, turned(node.r), rotation ** 2 @ node.s
    for animation in scene.animations:
        for track in animation.tracks:
            if track.path == "t":
                track.values = factor * track.values @ rotation.T
            if track.path == "r":
                track.values = np.array([turned(v) for v in track.values])
    g = np.eye(4)
    g[:3, :3] = factor * rotation
    back = np.linalg.inv(g)
    for skin in scene.skins:
        skin.inverse_binds = [g @ b @ back for b in skin.inverse_binds]
    for mesh in scene.meshes:
        mesh.positions = factor * mesh.positions @ rotation.T
        mesh.morphs = [(n, factor * d @ rotation.T, w) for n, d, w in mesh.morphs]


def reframe(scene, right):
    """Gives nodes other axes: the world matrix of a node is multiplied from the right by right[node]."""
    done = [(node, right.get(id(node.parent), np.eye(4)), right.get(id(node), np.eye(4))) for node in scene.nodes]
    new = []
    for node, above, own in done:
        left = np.linalg.inv(above)
        t, r, s = split_trs(left @ node.local() @ own)
        if not np.allclose(trs(t, r, s), left @ node.local() @ own, atol=1e-9):
            return False
        for animation in scene.animations:
            mine = {tr.path: tr for tr in animation.tracks if tr.node is node}
            if not mine:
                continue
            paths = set(mine)
            if not np.allclose(own[:3, 3], 0):
                paths |= {"t"} if "r" in paths else set()
            for path in paths:
                times = mine[path].times if path in mine else mine["r"].times
                values = []
                for time in times:
                    at = {p: mine[p].at(time) if p in mine else None for p in "trs"}
                    local = trs(node.t if at["t"] is None else at["t"], node.r if at["r"] is None else at["r"],
                                node.s if at["s"] is None else at["s"])
                    values.append(split_trs(left @ local @ own)["trs".index(path)])
                track = Track(node, path, times, values, path in mine and mine[path].step)
                track.corners = getattr(mine.get(path), "corners", None) if path in mine and np.allclose(
                    own[:3, 3], 0) else None
                new.append((animation, mine.get(path), track))
        node.new = (t, r, s)
    for animation, old, track in new:
        if old is not None:
            animation.tracks.remove(old)
        animation.tracks.append(track)
    for node, _, own in done:
        node.t, node.r, node.s = node.new
    for skin in scene.skins:
        skin.inverse_binds = [np.linalg.inv(right.get(id(j), np.eye(4))) @ b
                              for j, b in zip(skin.joints, skin.inverse_binds)]
    return True


def joint_frames(scene, draw):
    kind = draw.pick("joint axes", None, ["right angles", "any", "scaled", "mirrored", "identity binds"], 0.35)
    if kind is None:
        return
    rng = draw.rng("joint axes values")
    worlds = scene.worlds()
    right = {}
    for node in scene.nodes:
        if node.role is None:
            continue
        own = np.eye(4)
        if kind in ("right angles", "any"):
            own[:3, :3] = quat_matrix(random_rotation(rng, kind == "right angles"))
        elif kind == "scaled":
            own[:3, :3] *= rng.choice([0.5, 1, 2, 2.54])
        elif kind == "mirrored" and rng.random() < 0.5:
            own[:3, :3] = np.diag([-1, 1, 1])
        elif kind == "identity binds":
            own[:3, 3] = -worlds[id(node)][:3, 3]
        right[id(node)] = own
    reframe(scene, right)


def above(scene, draw):
    """Nodes above the root joint that the root joint takes back."""
    kind = draw.pick("node above", None, ["turned", "moved", "mirrored", "scaled", "stretched", "plain"], 0.4)
    if kind is None:
        return
    rng = draw.rng("node above values")
    node = Node(rng.choice(["Armature", "root", "RootNode.001", "Null"]))
    if kind == "turned":
        node.r = random_rotation(rng, rng.random() < 0.5)
    elif kind == "moved":
        node.t = np.array([rng.uniform(-3, 3) for _ in range(3)])
    elif kind == "mirrored":
        node.s = np.array(rng.choice([(-1, 1, 1), (1, 1, -1), (-1, -1, -1)]), float)
    elif kind == "scaled":
        node.s = np.full(3, rng.choice([0.01, 0.5, 100]))
    elif kind == "stretched":
        node.s = np.array([rng.choice([0.5, 1, 2]) for _ in range(3)])
    back = np.linalg.inv(node.local())
    for root in [n for n in scene.nodes if n.parent is None and n.role]:
        old = root.local()
        made = split_trs(back @ old)
        if not np.allclose(trs(*made), back @ old, atol=1e-9):
            return
        for animation in scene.animations:
            for track in [t for t in animation.tracks if t.node is root]:
                at = {"t": root.t, "r": root.r, "s": root.s}
                values = []
                for value in track.values:
                    at[track.path] = value
                    values.append(split_trs(back @ trs(at["t"], at["r"], at["s"]))["trs".index(track.path)])
                track.values = np.array(values)
        root.t, root.r, root.s = made
        root.parent = node
    scene.nodes.append(node)


def placed(scene, draw):
    """The whole character elsewhere, which changes no contact."""
    if not draw.yes("placed elsewhere", 0.2):
        return
    rng = draw.rng("placed elsewhere values")
    node = Node("place", None, [rng.uniform(-5, 5) for _ in range(3)], random_rotation(rng))
    for root in [n for n in scene.nodes if n.parent is None]:
        root.parent = node
    scene.nodes.append(node)


def bind_space(scene, draw):
    """The mesh in a space of its own; the inverse bind matrices take it back."""
    kind = draw.pick("mesh space", None, ["turned", "moved", "scaled", "mirrored", "centimetres"], 0.3)
    if kind is None:
        return
    rng = draw.rng("mesh space values")
    for mesh in scene.meshes:
        g = np.eye(4)
        if kind == "turned":
            g[:3, :3] = quat_matrix(random_rotation(rng, True))
        elif kind == "moved":
            g[:3, 3] = [rng.uniform(-1, 1) for _ in range(3)]
        elif kind == "scaled":
            g[:3, :3] *= rng.choice([0.1, 3])
        elif kind == "centimetres":
            g[:3, :3] *= 100
        else:
            g[:3, :3] = np.diag([-1, 1, 1])
        mesh_space(mesh, g)
    share_skins(scene)


def mesh_space(mesh, g):
    """Moves a mesh's vertices by g, and its skin takes that back."""
    mesh.positions = mesh.positions @ g[:3, :3].T + g[:3, 3]
    mesh.morphs = [(n, d @ g[:3, :3].T, w) for n, d, w in mesh.morphs]
    back = np.linalg.inv(g)
    mesh.skin = Skin(mesh.skin.joints, [b @ back for b in mesh.skin.inverse_binds])
    if np.linalg.det(g[:3, :3]) < 0:
        mesh.triangles = mesh.triangles[:, ::-1]


def share_skins(scene):
    scene.skins = []
    for mesh in scene.meshes:
        for skin in scene.skins:
            if skin.joints == mesh.skin.joints and np.allclose(skin.inverse_binds, mesh.skin.inverse_binds):
                mesh.skin = skin
                break
        else:
            scene.skins.append(mesh.skin)


def rest_elsewhere(scene, draw):
    """Nodes at rest as in some frame of the motion, while the skin is bound as ever."""
    if not draw.yes("rest is not bind", 0.2):
        return
    frame = draw.rng("rest is not bind value").randrange(25)
    for track in scene.animations[0].tracks:
        setattr(track.node, track.path, track.at(frame / 30).copy())


def helpers(scene, draw):
    """Nodes between joints, and ends that carry nothing."""
    if draw.yes("nodes between joints", 0.2):
        rng = draw.rng("nodes between joints values")
        for node in [n for n in scene.nodes if n.role and n.parent is not None and n.parent.role]:
            if rng.random() < 0.3:
                extra = Node(f"{node.name}_offset", node.parent, [rng.uniform(-0.1, 0.1) for _ in range(3)],
                             random_rotation(rng))
                back = np.linalg.inv(extra.local())
                for track in tracks_of(scene, node):
                    at = {"t": node.t, "r": node.r, "s": node.s}
                    values = []
                    for value in track.values:
                        at[track.path] = value
                        values.append(split_trs(back @ trs(at["t"], at["r"], at["s"]))["trs".index(track.path)])
                    track.values = np.array(values)
                node.t, node.r, node.s = split_trs(back @ node.local())
                node.parent = extra
                scene.nodes.append(extra)
    if draw.yes("end bones", 0.3):
        for node in [n for n in scene.nodes if n.role in ("Head", "LeftHand", "RightHand", "LeftFoot", "RightFoot")]:
            way = {"Head": (0, 0.22, 0), "LeftHand": (0.18, 0, 0), "RightHand": (-0.18, 0, 0)}
            end = Node(node.name + "_end", node, way.get(node.role, (0, -0.05, 0.15)))
            scene.nodes.append(end)
            if draw.rng("end bones are joints").random() < 0.5:
                for skin in scene.skins:
                    if node in skin.joints:
                        local = np.linalg.inv(end.local())
                        skin.inverse_binds = list(skin.inverse_binds) + [
                            local @ skin.inverse_binds[skin.joints.index(node)]]
                        skin.joints = list(skin.joints) + [end]
    if draw.yes("empty nodes", 0.3):
        rng = draw.rng("empty nodes values")
        for k in range(rng.randrange(1, 4)):
            scene.nodes.append(Node(f"Empty.{k:03}", rng.choice([None] + [n for n in scene.nodes if n.role]),
                                    [rng.uniform(-1, 1) for _ in range(3)]))


def twins(scene, draw):
    """A second joint in the place of some, which takes a part of their weights: up to 8 influences."""
    if not draw.yes("twist joints", 0.15):
        return
    rng = draw.rng("twist joints values")
    for mesh in scene.meshes:
        skin = mesh.skin
        joints, binds = list(skin.joints), list(skin.inverse_binds)
        bones, weights = [mesh.bones], [mesh.weights]
        for copy in range(rng.randrange(1, 4)):
            number = {}
            for k, joint in enumerate(skin.joints):
                if joint.role and rng.random() < 0.7:
                    twin = Node(f"{joint.name}_twist{copy}", joint)
                    scene.nodes.append(twin)
                    number[k] = len(joints)
                    joints.append(twin)
                    binds.append(skin.inverse_binds[k])
            share = rng.uniform(0.1, 0.3)
            has = np.isin(mesh.bones, list(number))
            moved = np.where(has, mesh.weights * share, 0)
            bones.append(np.array([[number.get(b, b) for b in row] for row in mesh.bones.tolist()]))
            weights.append(moved)
            weights[0] = weights[0] - moved
        mesh.bones, mesh.weights = np.hstack(bones), np.hstack(weights)
        mesh.skin = Skin(joints, binds)
    share_skins(scene)


def split(scene, draw, with_root):
    """Several meshes: by body part, or a limb with a skin of its own."""
    kind = draw.pick("several meshes", None, ["halves", "parts", "a limb"], 0.35)
    if kind is None:
        return
    rng = draw.rng("several meshes values")
    whole = scene.meshes[0]
    names = sorted(set(scene.parts))
    if kind == "parts":
        group = {n: n for n in names}
    elif kind == "halves":
        group = {n: n.split(" ")[0] if " " in n else "middle" for n in names}
    else:
        side, limb = rng.choice(["left", "right"]), rng.choice([("upper arm", "forearm", "hand"), ("thigh", "shin", "foot")])
        group = {n: "limb" if n.startswith(side) and n.endswith(limb) else "rest" for n in names}
    own_skin = kind == "a limb" or rng.random() < 0.4
    labels = [group[p] for p in scene.parts]
    meshes, parts = [], []
    order = sorted(set(labels))
    rng.shuffle(order)
    for label in order:
        chosen = np.array([l == label for l in labels])
        used, corners = np.unique(whole.triangles[chosen], return_inverse=True)
        node = Node(label.replace(" ", "_"))
        scene.nodes.append(node)
        skin, bones = whole.skin, whole.bones[used]
        weights = whole.weights[used]
        if own_skin:
            kept = sorted(set(bones[weights > 0].tolist()) | ({0} if with_root else set()))
            rng.shuffle(kept)
            number = {b: k for k, b in enumerate(kept)}
            skin = Skin([whole.skin.joints[b] for b in kept], [whole.skin.inverse_binds[b] for b in kept])
            bones = np.array([[number.get(b, 0) for b in row] for row in bones.tolist()])
        mesh = Mesh(label, node, skin, whole.positions[used], bones, weights, corners.reshape(-1, 3))
        mesh.morphs = [(n, d[used], w) for n, d, w in whole.morphs]
        mesh.origin = whole.origin[used]
        meshes.append(mesh)
        parts += [p for p, l in zip(scene.parts, labels) if l == label]
    scene.nodes.remove(whole.node)
    scene.meshes, scene.parts = meshes, parts
    share_skins(scene)


def vertices(scene, draw):
    """The same triangles of other vertices in another order."""
    kind = draw.pick("vertices", None, ["split", "split a little", "unused", "shuffled"], 0.4)
    flat = draw.yes("zero-area triangles", 0.2)
    turned = draw.yes("triangles shuffled", 0.2)
    rng = draw.rng("vertices values")
    for mesh in scene.meshes:
        n = len(mesh.positions)
        take = list(range(n))
        corners = mesh.triangles.copy()
        if kind == "split":
            take, corners = corners.reshape(-1).tolist(), np.arange(corners.size).reshape(-1, 3)
        elif kind == "split a little":
            for t in range(len(corners)):
                for k in range(3):
                    if rng.random() < 0.2:
                        take.append(int(corners[t][k]))
                        corners[t][k] = len(take) - 1
        elif kind == "unused":
            take += [rng.randrange(n) for _ in range(20)]
        elif kind == "shuffled":
            rng.shuffle(take)
            where = np.argsort(take)
            corners = where[corners]
        if turned:
            order = list(range(len(corners)))
            rng.shuffle(order)
            corners = np.array([np.roll(corners[t], rng.randrange(3)) for t in order])
        if flat:
            corners = np.vstack([corners, [[c[0], c[1], c[rng.choice([0, 1])]] for c in corners[:5]]])
        mesh.positions, mesh.bones, mesh.weights = mesh.positions[take], mesh.bones[take], mesh.weights[take]
        mesh.origin = mesh.origin[take]
        if kind == "unused":
            mesh.positions[n:] += 0.01
            mesh.origin[n:] = -1
        mesh.morphs = [(m, d[take], w) for m, d, w in mesh.morphs]
        mesh.triangles = corners


def joint_order(scene, draw):
    if not draw.yes("joints shuffled", 0.3):
        return
    rng = draw.rng("joints shuffled values")
    for skin in scene.skins:
        order = list(range(len(skin.joints)))
        rng.shuffle(order)
        where = np.argsort(order)
        skin.joints = [skin.joints[k] for k in order]
        skin.inverse_binds = [skin.inverse_binds[k] for k in order]
        for mesh in scene.meshes:
            if mesh.skin is skin:
                mesh.bones = where[mesh.bones]
    rng.shuffle(scene.nodes)


def morphs(scene, draw):
    kind = draw.pick("morph targets", None, ["at 0", "constant"], 0.2)
    if kind is None:
        return
    rng = np.random.default_rng(draw.rng("morph targets values").randrange(1 << 30))
    for mesh in scene.meshes:
        for k in range(int(rng.integers(1, 4))):
            deltas = rng.uniform(-0.008, 0.008, mesh.positions.shape) * (rng.random((len(mesh.positions), 1)) < 0.3)
            weight = 0.0 if kind == "at 0" else float(rng.choice([0.25, 0.5, 1.0]))
            mesh.positions = mesh.positions - weight * deltas
            mesh.morphs.append((f"shape{k}", deltas, weight))


def timing(scene, draw, sparse):
    """Keys that say the same at each frame. `sparse`: turns between keys go along the great circle in this format."""
    if sparse and draw.yes("few keys", 0.3):
        for track in scene.animations[0].tracks:
            corners = getattr(track, "corners", None)
            if corners is not None:
                track.values = track.values[corners]
                track.times = track.times[corners]
    if draw.yes("rounded times", 0.15):
        digits = draw.rng("rounded times value").choice([4, 5])
        for track in scene.animations[0].tracks:
            track.times = np.round(track.times, digits)


def vary(scene, draw, form):
    """`form` says what the format can: sets of names."""
    scheme = draw.pick("names", "plain", [s for s in SCHEMES if s != "plain"], 0.4)
    if "morphs" in form:
        morphs(scene, draw)
    helpers(scene, draw)
    twins(scene, draw)
    if "several meshes" in form:
        split(scene, draw, "root in skins" in form)
    vertices(scene, draw)
    if "joint axes" in form:
        joint_frames(scene, draw)
    if "node above" in form:
        above(scene, draw)
    if "rest" in form:
        rest_elsewhere(scene, draw)
    rename(scene, scheme, draw.rng("names values"))
    up = draw.pick("up axis", "y", ["z", "x"], 0.3)
    unit = draw.pick("unit", 1.0, [0.01, 0.0254, 0.001, 0.1], 0.4)
    reexpress(scene, UP[up], 1 / unit)
    scene.unit, scene.up_name = unit, up
    if "mesh space" in form:
        bind_space(scene, draw)
    if "node above" in form:
        placed(scene, draw)
    joint_order(scene, draw)
    timing(scene, draw, "sparse" in form)
