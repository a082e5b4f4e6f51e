# The scene of the trials in Godot 3: run by godot3.mjs, with the words of the scene in a file that
# the variable HSHFIT_SCENE of the environment names.
extends SceneTree

var words = {}
var picture = null
var frames = 0

func vector(numbers):
	return Vector3(numbers[0], numbers[1], numbers[2])

func text_of(path):
	var file = File.new()
	file.open(path, File.READ)
	return file.get_as_text()

func material_of():
	if words.has("shader"):
		var own = ShaderMaterial.new()
		own.shader = Shader.new()
		own.shader.code = text_of(words.shader)
		return own
	var standard = SpatialMaterial.new()
	standard.albedo_color = Color(words.albedo[0], words.albedo[1], words.albedo[2])
	standard.metallic = words.metallic
	standard.roughness = words.roughness
	return standard

func _init():
	words = JSON.parse(text_of(OS.get_environment("HSHFIT_SCENE"))).result
	picture = Viewport.new()
	picture.size = Vector2(words.side, words.side)
	picture.hdr = true
	picture.keep_3d_linear = true
	picture.own_world = true
	picture.transparent_bg = words.kind == "direct"
	picture.render_target_update_mode = Viewport.UPDATE_ALWAYS
	picture.render_target_v_flip = true
	root.add_child(picture)
	var ball = MeshInstance.new()
	var sphere = SphereMesh.new()
	sphere.radial_segments = 256
	sphere.rings = 128
	# Normals anew, without the compression that rounds them to eight bits.
	var arrays = sphere.get_mesh_arrays()
	var normals = PoolVector3Array()
	for place in arrays[Mesh.ARRAY_VERTEX]:
		normals.append(place.normalized())
	arrays[Mesh.ARRAY_NORMAL] = normals
	ball.mesh = ArrayMesh.new()
	ball.mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays, [], 0)
	ball.material_override = material_of()
	picture.add_child(ball)
	var camera = Camera.new()
	picture.add_child(camera)
	camera.fov = words.angle
	camera.environment = Environment.new()
	camera.environment.ambient_light_energy = 0
	camera.environment.background_mode = Environment.BG_COLOR
	camera.look_at_from_position(vector(words.eye), Vector3(0, 0, 0), Vector3(0, 1, 0))
	camera.current = true
	if words.kind == "direct":
		var lamp = DirectionalLight.new()
		picture.add_child(lamp)
		lamp.look_at_from_position(vector(words.towards), Vector3(0, 0, 0), Vector3(0, 1, 0))
		lamp.light_energy = words.energy
		lamp.light_specular = 1
	else:
		var image = Image.new()
		image.load(words.picture)
		var panorama = ImageTexture.new()
		panorama.create_from_image(image, Texture.FLAG_FILTER)
		var sky = PanoramaSky.new()
		sky.radiance_size = Sky.RADIANCE_SIZE_256
		sky.panorama = panorama
		camera.environment.background_mode = Environment.BG_SKY
		camera.environment.background_sky = sky
		camera.environment.background_sky_rotation_degrees = Vector3(0, words.sky_turn, 0)
		camera.environment.ambient_light_energy = 1
		camera.environment.ambient_light_sky_contribution = 1

func _idle(_delta):
	frames += 1
	if frames == 8:
		var image = picture.get_texture().get_data()
		image.convert(Image.FORMAT_RGBAF)
		var file = File.new()
		file.open(words.out, File.WRITE)
		file.store_buffer(image.get_data())
		file.close()
		quit()
	return false
