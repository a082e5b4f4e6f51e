"""The sky of Hosek and Wilkie against Cycles, which has the authors' tables of XYZ compiled in:

    cmake --build --preset release --target sky_picture
    blender -b --factory-startup --python-exit-code 1 -P tests/gpu/renderers/blender_sky.py -- \
        build/tests/gpu/renderers/sky_picture FOLDER

The tables are read out of Blender's own program and written into FOLDER in the layout that the
authors publish, so that no file of theirs is needed. Blender renders the sky as a panorama for each
case, and the program's light by these tables is compared pixel by pixel above the horizon."""
import math
import subprocess
import sys
from pathlib import Path

import bpy
import numpy

TOOL, FOLDER = sys.argv[sys.argv.index("--") + 1:]
WIDTH = 512
# Turbidity, elevation of the sun in degrees, albedo of the ground.
CASES = [(1, 20, 0), (2.2, 60, 0.3), (3, 35, 0.5), (4.7, 2, 0.1), (7.5, 45, 1), (10, 80, 0.2),
         (10, 10, 0.8)]
# Cycles scales the sky by this, where the program has 0.683, 1000 cd/m^2.
CYCLES, OURS = 2 * math.pi / 683, 0.683


def tables():
    """The six arrays in Blender's program: 3600 numbers in a row, the only run of this length whose
    numbers have seven decimal digits. The compiler lays them out from the last to the first."""
    program = Path(bpy.app.binary_path).read_bytes()
    values = numpy.frombuffer(program[:len(program) // 8 * 8], "<f8")
    with numpy.errstate(invalid="ignore"):
        near = numpy.flatnonzero((abs(values) > 1e-12) & (abs(values) < 1e4))
    short = numpy.zeros(len(values) + 2, bool)
    for at in near:
        short[at + 1] = float("%.6e" % values[at]) == values[at]
    ends = numpy.flatnonzero(short[1:] != short[:-1])
    runs = [(a, b) for a, b in zip(ends[::2], ends[1::2]) if b - a == 3600]
    if len(runs) != 1:
        sys.exit(f"{bpy.app.binary_path}: {len(runs)} runs of 3600 numbers of seven digits; valid: "
                 "one, as Debian's Blender 3.4 has")
    numbers, arrays = values[runs[0][0]:runs[0][1]], {}
    for channel in (3, 2, 1):
        for name, size in (("Rad", 120), ("", 1080)):
            arrays[f"datasetXYZ{name}{channel}"], numbers = numbers[:size], numbers[size:]
    return arrays


def written(arrays, path):
    with open(path, "w", encoding="ascii") as file:
        for name in sorted(arrays):
            file.write(f"double {name}[] =\n{{\n")
            rows = arrays[name].reshape(20, -1)
            for number, row in enumerate(rows):
                file.write(f"\t// albedo {number // 10}, turbidity {number % 10 + 1}\n")
                file.writelines(f"\t{value:.6e},\n" for value in row)
            file.write("};\n\n")
    return path


def panorama():
    """A scene of the sky alone, seen all around with +x in the middle; its node."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    world = scene.world = bpy.data.worlds.new("world")
    world.use_nodes = True
    nodes = world.node_tree.nodes
    sky = nodes.new("ShaderNodeTexSky")
    sky.sky_type = "HOSEK_WILKIE"
    world.node_tree.links.new(sky.outputs["Color"], nodes["Background"].inputs["Color"])
    scene.render.engine = "CYCLES"
    eye = bpy.data.objects.new("eye", bpy.data.cameras.new("eye"))
    eye.data.type = "PANO"
    eye.data.cycles.panorama_type = "EQUIRECTANGULAR"
    eye.rotation_euler = (math.pi / 2, 0, -math.pi / 2)
    scene.collection.objects.link(eye)
    scene.camera = eye
    render = scene.render
    render.resolution_x, render.resolution_y = WIDTH, WIDTH // 2
    render.resolution_percentage = 100
    render.threads_mode, render.threads = "FIXED", 1
    scene.view_settings.view_transform = "Raw"
    cycles = scene.cycles
    # One ray through the middle of each pixel.
    cycles.device, cycles.samples, cycles.seed = "CPU", 1, 1
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.pixel_filter_type, cycles.filter_width = "GAUSSIAN", 0.01
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth, render.image_settings.exr_codec = "32", "NONE"
    return sky


def pixels(path):
    """[row from the bottom][column][R, G, B] of a picture of linear values."""
    image = bpy.data.images.load(str(path), check_existing=False)
    image.colorspace_settings.name = "Non-Color"
    values = numpy.empty(len(image.pixels), numpy.float32)
    image.pixels.foreach_get(values)
    return values.reshape(WIDTH // 2, WIDTH, -1)[:, :, :3].astype(float)


def ours(path):
    with open(path, "rb") as file:
        for _ in range(3):
            file.readline()
        return numpy.frombuffer(file.read(), "<f4").reshape(WIDTH // 2, WIDTH, 3).astype(float)


def main():
    folder = Path(FOLDER).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    data = written(tables(), folder / "ArHosekSkyModelData_CIEXYZ.h")
    lines, all_found, all_expected = [], [], []
    for number, (turbidity, elevation, albedo) in enumerate(CASES):
        sky = panorama()
        sky.turbidity, sky.ground_albedo = turbidity, albedo
        azimuth, height = math.radians(35), math.radians(elevation)
        sky.sun_direction = (math.cos(height) * math.cos(azimuth),
                             math.cos(height) * math.sin(azimuth), math.sin(height))
        picture, own = folder / f"cycles-{number}.exr", folder / f"ours-{number}.pfm"
        bpy.context.scene.render.filepath = str(picture)
        bpy.ops.render.render(write_still=True)
        light = (f"hosek-wilkie:data={data},turbidity={turbidity},albedo={albedo},"
                 f"elevation={elevation},azimuth=35")
        subprocess.run([TOOL, light, str(WIDTH), str(own)], check=True)
        expected = pixels(picture)[WIDTH // 4:] / CYCLES
        found = ours(own)[WIDTH // 4:] / OURS
        error = abs(found - expected).max(axis=2) / expected.max(axis=2)
        row, column = numpy.unravel_index(error.argmax(), error.shape)
        all_found.append(found.reshape(-1, 3))
        all_expected.append(expected.reshape(-1, 3))
        lines.append(f"turbidity {turbidity}, sun at {elevation} degrees, albedo {albedo}: largest "
                     f"difference {error.max():.2e} at elevation {(row + .5) * 360 / WIDTH:.1f}, "
                     f"azimuth {180 - (column + .5) * 360 / WIDTH:.1f}; mean {error.mean():.2e}")
    found, expected = numpy.concatenate(all_found), numpy.concatenate(all_expected)
    brightest = expected.max(axis=1)
    worst = (abs(found - expected).max(axis=1) / brightest).max()
    # Both matrices from XYZ differ in their last digits: the rest after the best 3x3 matrix.
    kept = expected.min(axis=1) > 0
    matrix = numpy.linalg.lstsq(found[kept] / brightest[kept, None],
                                expected[kept] / brightest[kept, None], rcond=None)[0]
    rest = (abs(found[kept] @ matrix - expected[kept]).max(axis=1) / brightest[kept]).max()
    print(*lines, matrix, sep="\n")
    print(f"largest of all: {worst:.2e} of the brightest component of its pixel; {rest:.2e} after "
          "this matrix of colours, the best")
    if not worst < 1e-3:
        sys.exit("the skies differ")


main()
