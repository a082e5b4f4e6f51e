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



def extensions(path):
    """The extensions of a .glb's material."""
    data = open(path, "rb").read()
    text = data[20:20 + struct.unpack("<I", data[12:16])[0]]
    return json.loads(text)["materials"][0].get("extensions", {})


def principled(material):
    return next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")


def brush(material, found):
    """Anisotropy, which the importer leaves out. glTF's two roughnesses are alpha + (1 - alpha) s^2
    along the tangent, turned by the rotation, and alpha across it, s the strength; Principled's are
    r^2 / aspect and r^2 aspect, with aspect^2 = 1 - 0.9 anisotropic. The tangent runs along the
    parallels."""
    tree, inputs = material.node_tree, principled(material).inputs
    across = inputs["Roughness"].default_value ** 2
    along = across + (1 - across) * found.get("anisotropyStrength", 0) ** 2
    inputs["Roughness"].default_value = (along * across) ** 0.25
    inputs["Anisotropic"].default_value = min(1, (1 - across / along) / 0.9)
    turns = found.get("anisotropyRotation", 0) / (2 * math.pi)
    inputs["Anisotropic Rotation"].default_value = turns % 1
    tangent = tree.nodes.new("ShaderNodeTangent")
    tangent.direction_type, tangent.axis = "RADIAL", "Z"
    tree.links.new(tangent.outputs["Tangent"], inputs["Tangent"])


def set_specular(material, found):
    """The reflectance at normal incidence, 0.08 for Principled's specular of 1, where the importer
    overlooks the factor beside an index of refraction."""
    ior = found.get("KHR_materials_ior", {}).get("ior", 1.5)
    factor = found.get("KHR_materials_specular", {}).get("specularFactor", 1)
    reflectance = ((ior - 1) / (ior + 1)) ** 2 * factor
    principled(material).inputs["Specular"].default_value = reflectance / 0.08


found = extensions(words["glb"])
for thing in scene.objects:
    if thing.type == "MESH":
        set_specular(thing.active_material, found)
        if "KHR_materials_anisotropy" in found:
            brush(thing.active_material, found["KHR_materials_anisotropy"])

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
