# SPDX-License-Identifier: GPL-3.0-or-later
"""unreal_stub.py FOLDER FILE BONES AXES: as much of Unreal's Python as spherechain_colliders.py of FOLDER needs. Runs it
on a physics asset with a body for each of BONES, whose bones have scales of their own; prints the bodies, at the
bones' scale, and the pairs that are left to the user, as JSON."""
import json
import sys
import types

folder, file, bones, axes = sys.argv[1:]
unreal = types.ModuleType("unreal")


class Struct:
    """Knows its properties; refuses others."""
    properties = ()

    def __init__(self):
        self.values = {}

    def set_editor_property(self, name, value):
        if name not in self.properties:
            raise AttributeError(f"{type(self).__name__} has no {name}")
        self.values[name] = value

    def get_editor_property(self, name):
        if name not in self.properties:
            raise AttributeError(f"{type(self).__name__} has no {name}")
        return self.values.get(name)


def struct(name, *properties):
    setattr(unreal, name, type(name, (Struct,), {"properties": properties}))


struct("KSphereElem", "center", "radius")
struct("KSphylElem", "center", "rotation", "radius", "length")
struct("KTaperedCapsuleElem", "center", "rotation", "radius0", "radius1", "length")
struct("KBoxElem", "center", "rotation", "x", "y", "z")
struct("KAggregateGeom", "sphere_elems", "sphyl_elems", "box_elems", "tapered_capsule_elems")


class Vector:
    def __init__(self, x=0.0, y=0.0, z=0.0):
        self.x, self.y, self.z = x, y, z


class Rotator:
    def __init__(self, roll=0.0, pitch=0.0, yaw=0.0):
        self.roll, self.pitch, self.yaw = roll, pitch, yaw


class Name:
    def __init__(self, text):
        self.text = text

    def __str__(self):
        return self.text


class SkeletalBodySetup(Struct):
    properties = ("bone_name", "agg_geom")

    def __init__(self, outer, bone):
        super().__init__()
        self.outer = outer
        self.values["bone_name"] = Name(bone)

    def get_outer(self):
        return self.outer


class SkeletalMesh(Struct):
    properties = ("physics_asset",)


class SkeletonModifier:
    def set_skeletal_mesh(self, mesh):
        self.mesh = mesh

    def get_bone_transform(self, bone, global_=False):
        assert global_ and self.mesh is mesh
        return types.SimpleNamespace(scale3d=Vector(*(3 * [scale_of[bone]])))


names = json.load(open(bones, encoding="utf-8"))
scale_of = {bone: (1.0, 0.01, 100.0)[i % 3] for i, bone in enumerate(names)}
mesh, asset, other = SkeletalMesh(), object(), object()
setups = [SkeletalBodySetup(other, names[0])] + [SkeletalBodySetup(asset, bone) for bone in names]
saved = []
for one in (Vector, Rotator, SkeletalBodySetup, SkeletonModifier):
    setattr(unreal, one.__name__, one)
unreal.load_asset = lambda path: mesh
unreal.SkeletalMeshEditorSubsystem = "subsystem"
unreal.get_editor_subsystem = lambda which: types.SimpleNamespace(create_physics_asset=lambda mesh, assign=True: asset)
unreal.ObjectIterator = lambda kind: iter(setups)
unreal.EditorAssetLibrary = types.SimpleNamespace(save_loaded_asset=saved.append)
unreal.log = unreal.log_warning = lambda text: print(text, file=sys.stderr)
sys.modules["unreal"] = unreal
sys.path.insert(0, folder)
sys.dont_write_bytecode = True
import spherechain_colliders  # noqa: E402

sys.stderr = open("/dev/null", "w")
pairs = spherechain_colliders.apply(file, "/Game/Mesh", axes)
assert saved == [asset] and setups[0].get_editor_property("agg_geom") is None


def scaled(value, scale):
    """What Unreal makes of a shape in a bone of this scale: lengths grow, rotations stay."""
    if isinstance(value, Struct):
        return {key: scaled(one, scale) for key, one in value.values.items()}
    if isinstance(value, list):
        return [scaled(one, scale) for one in value]
    if isinstance(value, Vector):
        return {"x": value.x * scale, "y": value.y * scale, "z": value.z * scale}
    return vars(value) if isinstance(value, Rotator) else value * scale


bodies = {}
for setup in setups[1:]:
    bone = str(setup.get_editor_property("bone_name"))
    bodies[bone] = {"agg_geom": scaled(setup.get_editor_property("agg_geom"), scale_of[bone])}
print(json.dumps({"pairs": pairs, "setups": bodies}))
