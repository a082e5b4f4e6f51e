"""The scene of the trials in Blender, by its glTF importer: run by blender.mjs as
blender -b --factory-startup -P blender.py -- JSON, with the words of the scene in a file."""
import json
import math
import struct
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



def anisotropy(path):
    """Strength and rotation of KHR_materials_anisotropy, which the importer leaves out."""
    data = open(path, "rb").read()
    text = data[20:20 + struct.unpack("<I", data[12:16])[0]]
    extensions = json.loads(text)["materials"][0].get("extensions", {})
    found = extensions.get("KHR_materials_anisotropy", {})
    return found.get("anisotropyStrength", 0), found.get("anisotropyRotation", 0)


def brush(material, strength, rotation):
    """The Principled BSDF with glTF's two roughnesses: alpha + (1 - alpha) strength^2 along the
    tangent, turned by the rotation, and alpha across it; Principled's are r^2 / aspect and r^2 aspect,
    with aspect^2 = 1 - 0.9 anisotropic. The tangent runs along the parallels."""
    tree = material.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    across = shader.inputs["Roughness"].default_value ** 2
    along = across + (1 - across) * strength ** 2
    shader.inputs["Roughness"].default_value = (along * across) ** 0.25
    shader.inputs["Anisotropic"].default_value = min(1, (1 - across / along) / 0.9)
    shader.inputs["Anisotropic Rotation"].default_value = rotation / (2 * math.pi) % 1
    tangent = tree.nodes.new("ShaderNodeTangent")
    tangent.direction_type, tangent.axis = "RADIAL", "Z"
    tree.links.new(tangent.outputs["Tangent"], shader.inputs["Tangent"])


strength, rotation = anisotropy(words["glb"])
if strength > 0:
    for thing in scene.objects:
        if thing.type == "MESH":
            brush(thing.active_material, strength, rotation)

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
