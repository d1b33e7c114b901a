# Shows scene.glb by lightmap.exr, which lie beside this script: attach it to a Node3D.
extends Node3D

# The nodes of scene.glb that have a place in the light map.
const NODES: Array[String] = [{{nodes}}]

func _ready() -> void:
	var folder: String = get_script().resource_path.get_base_dir()
	var scene: Node3D = load(folder + "/scene.glb").instantiate()
	scene.name = "Scene"
	add_child(scene)
	# TEXCOORD_1 is the place in the atlas itself, so that every user's rectangle is the whole.
	var data := LightmapGIData.new()
	var textures: Array[TextureLayered] = [load(folder + "/lightmap.exr")]
	data.lightmap_textures = textures
	data.set_uses_spherical_harmonics(false)
	for node in NODES:
		var mesh: GeometryInstance3D = scene.get_node(node)
		mesh.gi_mode = GeometryInstance3D.GI_MODE_STATIC
		data.add_user(NodePath("../Scene/" + node), Rect2(0, 0, 1, 1), 0, -1)
	var light_map := LightmapGI.new()
	light_map.name = "LightmapGI"
	add_child(light_map)
	light_map.light_data = data
