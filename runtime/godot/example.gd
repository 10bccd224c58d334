# SPDX-License-Identifier: MIT
# Prints which body parts of a character penetrate each other, and turns its arms out of the body. Add the script to a node below
# the character's root, and name the skeleton and the asset in the inspector.
extends Node

@export var skeleton: Skeleton3D
@export_file("*.sphc") var asset := "res://hero.sphc"
@export var corrects := true

var body := SpherechainBody.new()
var response := SpherechainResponse.new()


func _ready() -> void:
	process_priority = 100  # after the AnimationPlayer
	if not body.load(asset) or not body.bind(skeleton) or not response.bind(body):
		set_process(false)  # the reason is in the output


func _process(delta: float) -> void:
	if corrects:
		response.apply(delta)
	for found in body.penetrations():
		print("%s in %s, %.3f deep; move bone %d by %v" % [found.part, found.other, found.depth, found.bone, found.direction * found.distance])
