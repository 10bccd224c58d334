# Colliders of a character, written by spherechain. They belong under its Skeleton3D.
extends PhysicalBoneSimulator3D

## Names of bodies that are not tested against each other, two by two.
@export var ignored: PackedStringArray


func _ready() -> void:
	for i in range(0, ignored.size(), 2):
		var a := get_node(ignored[i]) as PhysicalBone3D
		var b := get_node(ignored[i + 1]) as PhysicalBone3D
		PhysicsServer3D.body_add_collision_exception(a.get_rid(), b.get_rid())
		PhysicsServer3D.body_add_collision_exception(b.get_rid(), a.get_rid())
