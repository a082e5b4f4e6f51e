"""The scene of the trials in Blender, by its glTF importer: run by blender.mjs as
blender -b --factory-startup -P blender.py -- JSON, with the words of the scene in a file."""
import json
import math
import sys

import bpy
import numpy
from mathutils import Vector

# Debian's importer uses a name that its NumPy has dropped.
numpy.bool = bool
words = json.load(open(sys.argv[sys.argv.index("--") + 1]))
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
bpy.ops.import_scene.gltf(filepath=words["glb"])
for thing in scene.objects:
    if thing.type == "MESH":
        for polygon in thing.data.polygons:
            polygon.use_smooth = True

camera = bpy.data.objects.new("eye", bpy.data.cameras.new("eye"))
camera.data.angle = math.radians(words["angle"])
camera.location = words["eye"]
camera.rotation_euler = (-Vector(words["eye"])).to_track_quat("-Z", "Y").to_euler()
scene.collection.objects.link(camera)
scene.camera = camera

world = bpy.data.worlds.new("world")
scene.world = world
world.use_nodes = True
nodes, links = world.node_tree.nodes, world.node_tree.links
background = nodes["Background"]
if words["kind"] == "direct":
    background.inputs["Strength"].default_value = 0
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
    lamp.data.energy = words["irradiance"]
    lamp.data.angle = 0
    lamp.rotation_euler = (-Vector(words["towards"])).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(lamp)
else:
    picture = nodes.new("ShaderNodeTexEnvironment")
    picture.image = bpy.data.images.load(words["picture"])
    mapping = nodes.new("ShaderNodeMapping")
    place = nodes.new("ShaderNodeTexCoord")
    # The lookup is turned, so that the picture turns the other way.
    mapping.inputs["Rotation"].default_value = (0, 0, math.radians(words["lookup_turn"]))
    links.new(place.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], picture.inputs["Vector"])
    links.new(picture.outputs["Color"], background.inputs["Color"])

render = scene.render
render.engine = words["engine"]
render.resolution_x = render.resolution_y = words["size"]
render.resolution_percentage = 100
render.film_transparent = True
render.threads_mode = "FIXED"
render.threads = 1
scene.view_settings.view_transform = "Raw"
if words["engine"] == "CYCLES":
    scene.cycles.device = "CPU"
    scene.cycles.samples = words["samples"]
    scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.max_bounces = 0
    scene.cycles.seed = 1
else:
    scene.eevee.taa_render_samples = words["samples"]
    render.filter_size = 0.5
render.image_settings.file_format = "OPEN_EXR"
render.image_settings.color_depth = "32"
render.image_settings.exr_codec = "NONE"
render.filepath = words["out"]
bpy.ops.render.render(write_still=True)
