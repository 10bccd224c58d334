"""Written by spherechain: puts the colliders of a JSON file (spherechain export --to unreal) into a physics asset.

In the Unreal Editor, with the plugins Python Editor Script and Skeletal Mesh Modifiers (5.3 or newer):

    import sys; sys.path.append("FOLDER OF THIS FILE")
    import spherechain_colliders
    spherechain_colliders.apply("FOLDER/character.json", "/Game/Characters/Mesh")

`apply` takes the mesh's physics asset, or makes one, and replaces the shapes of the bodies that the file names. Unreal's
Python cannot add bodies, nor say which are tested against each other: `apply` lists what is left to do by hand.

The file is right-handed, in metres. Unreal is left-handed, in centimetres, and each importer turns every bone's space
in its own way: glTF swaps Y and Z, FBX mirrors Y. `axes` ("gltf" or "fbx") says which; left out, the ending of the
character's file does. Scale that a bone has in the mesh is taken out of the shapes, for Unreal puts it in again.
"""
import json
import math

import unreal

CENTIMETRES = 100.0


def turned(point, axes):
    """A point of a bone's space as the importer turned that."""
    x, y, z = (CENTIMETRES * c for c in point)
    return (x, z, y) if axes == "gltf" else (x, -y, z)


def turned_quaternion(q, axes):
    x, y, z, w = q
    return (-x, -z, -y, w) if axes == "gltf" else (-x, y, -z, w)


def rotated(q, v):
    """The vector v turned by the quaternion q."""
    x, y, z, w = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return (v[0] + w * t[0] + y * t[2] - z * t[1],
            v[1] + w * t[1] + z * t[0] - x * t[2],
            v[2] + w * t[2] + x * t[1] - y * t[0])


def rotator(q):
    """As Unreal's own, which is a milliradian off where the pitch is near 90 degrees."""
    x, y, z = (rotated(q, axis) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    yaw = math.atan2(x[1], x[0])
    level = (-math.sin(yaw), math.cos(yaw), 0)
    roll = math.atan2(sum(a * b for a, b in zip(z, level)), sum(a * b for a, b in zip(y, level)))
    pitch = math.atan2(x[2], math.hypot(x[0], x[1]))
    return unreal.Rotator(roll=math.degrees(roll), pitch=math.degrees(pitch), yaw=math.degrees(yaw))


def along(direction):
    """A rotation that takes +Z along a direction."""
    x, y, z = direction
    return unreal.Rotator(pitch=math.degrees(math.atan2(math.hypot(x, y), z)), yaw=math.degrees(math.atan2(-y, -x)))


def vector(point):
    return unreal.Vector(*point)


def shapes(volumes, axes, scale):
    """The aggregate geometry of a body's volumes in a bone of this scale."""
    balls, capsules, boxes, cones = [], [], [], []
    for volume in volumes:
        kind = volume["type"]
        if kind in ("sphere", "box"):
            center = vector(c / scale for c in turned(volume["center"], axes))
        if kind == "sphere":
            shape = unreal.KSphereElem()
            shape.set_editor_property("center", center)
            shape.set_editor_property("radius", CENTIMETRES * volume["radius"] / scale)
            balls.append(shape)
        elif kind == "box":
            half = volume["half"] if axes == "fbx" else [volume["half"][i] for i in (0, 2, 1)]
            shape = unreal.KBoxElem()
            shape.set_editor_property("center", center)
            shape.set_editor_property("rotation", rotator(turned_quaternion(volume["rotation"], axes)))
            for name, size in zip("xyz", half):
                shape.set_editor_property(name, 2 * CENTIMETRES * size / scale)
            boxes.append(shape)
        elif kind in ("capsule", "cone"):
            a, b = turned(volume["a"], axes), turned(volume["b"], axes)
            radii = (volume["radius_a"], volume["radius_b"]) if kind == "cone" else (volume["radius"],) * 2
            axis = [q - p for p, q in zip(a, b)]
            placed = {
                "center": vector((p + q) / 2 / scale for p, q in zip(a, b)),
                "rotation": along(axis),
                "length": sum(c * c for c in axis) ** 0.5 / scale,
            }
            # Rigid bodies take a tapered capsule for nothing or for one of its mean radius; cloth takes it as it is.
            shape = unreal.KSphylElem()
            for name, value in placed.items():
                shape.set_editor_property(name, value)
            shape.set_editor_property("radius", CENTIMETRES * sum(radii) / 2 / scale)
            capsules.append(shape)
            if kind == "cone":
                shape = unreal.KTaperedCapsuleElem()
                for name, value in placed.items():
                    shape.set_editor_property(name, value)
                shape.set_editor_property("radius0", CENTIMETRES * radii[1] / scale)  # the end at +Z
                shape.set_editor_property("radius1", CENTIMETRES * radii[0] / scale)
                cones.append(shape)
    geometry = unreal.KAggregateGeom()
    geometry.set_editor_property("sphere_elems", balls)
    geometry.set_editor_property("sphyl_elems", capsules)
    geometry.set_editor_property("box_elems", boxes)
    geometry.set_editor_property("tapered_capsule_elems", cones)
    return geometry


def apply(json_path, mesh_path, axes=None):
    with open(json_path, encoding="utf-8") as file:
        colliders = json.load(file)
    if colliders.get("writer") != "spherechain":
        raise ValueError(json_path + ": not a file of spherechain export --to unreal")
    if axes is None:
        axes = "fbx" if colliders["character"].lower().endswith(".fbx") else "gltf"
    if axes not in ("gltf", "fbx"):
        raise ValueError("axes: gltf or fbx")
    mesh = unreal.load_asset(mesh_path)
    if mesh is None:
        raise ValueError(mesh_path + ": no such asset")
    asset = mesh.get_editor_property("physics_asset")
    if asset is None:
        editor = unreal.get_editor_subsystem(unreal.SkeletalMeshEditorSubsystem)
        asset = editor.create_physics_asset(mesh, True)
    skeleton = unreal.SkeletonModifier()
    skeleton.set_skeletal_mesh(mesh)
    bodies = {str(body.get_editor_property("bone_name")): body
              for body in unreal.ObjectIterator(unreal.SkeletalBodySetup) if body.get_outer() == asset}
    missing = []
    for one in colliders["bodies"]:
        body = bodies.get(one["bone"])
        if body is None:
            missing.append(one["bone"])
            continue
        size = skeleton.get_bone_transform(one["bone"], True).scale3d
        body.set_editor_property("agg_geom", shapes(one["volumes"], axes, (size.x + size.y + size.z) / 3))
    unreal.EditorAssetLibrary.save_loaded_asset(asset)
    if missing:
        unreal.log_warning("spherechain: the physics asset has no body for " + ", ".join(missing) +
                           ": add them in its editor (Add Shape), then run this again")
    bone_of = {one["part"]: one["bone"] for one in colliders["bodies"]}
    pairs = [tuple(bone_of[part] for part in pair["parts"]) for pair in colliders["ignored"]]
    unreal.log("spherechain: in the physics asset's editor, let all bodies collide, then disable the collision of: " +
               "; ".join(a + " and " + b for a, b in pairs))
    return pairs
