"""Runs OSL shaders over queries in Cycles, Blender's renderer, on the processor.

    run_osl.py FOLDER...

Each folder holds the shader `main.osl` with the images it reads, and `queries.f32`, rows of 8
floats. A picture is rendered in which three pixels' worth of color, five times, are the answers to
a query; they go to `answers.f32`, rows of 16 floats. Prints the program's name.
"""

import struct
import sys
from pathlib import Path

import bpy
import _cycles  # Known after bpy.
import numpy as np

COLUMNS, ROWS, QUERY, ANSWER = 160, 256, 8, 16
WIDTH = 5 * COLUMNS


def write_tiff(path, texels):
    """A TIFF file of four floats per texel, `[row][column][channel]`."""
    height, width, _ = texels.shape
    at = 8 + 2 + 12 * 11 + 4
    entries = [
        (256, 4, 1, width), (257, 4, 1, height), (258, 3, 4, at), (259, 3, 1, 1),
        (262, 3, 1, 2), (273, 4, 1, at + 16), (277, 3, 1, 4), (278, 4, 1, height),
        (279, 4, 1, texels.nbytes), (338, 3, 1, 0), (339, 3, 4, at + 8),
    ]  # fmt: skip
    directory = b"".join(struct.pack("<HHII", *entry) for entry in entries)
    formats = struct.pack("<8H", *[32] * 4, *[3] * 4)
    head = b"II*\0" + struct.pack("<IH", 8, len(entries))
    path.write_bytes(head + directory + bytes(4) + formats + texels.tobytes())


def scene_of(bytecode):
    """A plane of one unit a pixel that glows in the color that the shader answers."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.shading_system = True
    scene.cycles.samples = 1
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, ROWS
    scene.render.resolution_percentage = 100
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", WIDTH
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.camera.location = (WIDTH / 2, ROWS / 2, 10)
    scene.collection.objects.link(scene.camera)
    mesh = bpy.data.meshes.new("plane")
    corners = [(0, 0, 0), (WIDTH, 0, 0), (WIDTH, ROWS, 0), (0, ROWS, 0)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    material = bpy.data.materials.new("answers")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    script, glow = nodes.new("ShaderNodeScript"), nodes.new("ShaderNodeEmission")
    surface = nodes.new("ShaderNodeOutputMaterial")
    script.mode, script.filepath = "EXTERNAL", str(bytecode)
    script.outputs.new("NodeSocketColor", "Answer")
    links.new(script.outputs["Answer"], glow.inputs["Color"])
    links.new(glow.outputs["Emission"], surface.inputs["Surface"])
    mesh.materials.append(material)
    scene.collection.objects.link(bpy.data.objects.new("plane", mesh))
    return scene


def run(folder):
    queries = np.fromfile(folder / "queries.f32", np.float32)
    count = queries.size // QUERY
    texels = np.zeros((ROWS, COLUMNS, QUERY), np.float32)
    texels.reshape(-1)[: queries.size] = queries
    write_tiff(folder / "queries.tif", texels.reshape(ROWS, 2 * COLUMNS, 4))
    payload = folder / "shader.textures"
    if payload.exists():
        # What the node reads: the first texture of a payload.
        width, height = struct.unpack_from("<2I", payload.read_bytes(), 16)
        texels = np.fromfile(payload, np.float32, 4 * width * height, offset=64)
        write_tiff(folder / "colors.tif", texels.reshape(height, width, 4))
    bytecode = folder / "main.oso"
    assert _cycles.osl_compile(str(folder / "main.osl"), str(bytecode)), folder
    scene = scene_of(bytecode)
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    scene.render.filepath = str(folder / "answers.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    # Rows from the bottom up, as P counts.
    pixels = np.empty(WIDTH * ROWS * 4, np.float32)
    image.pixels.foreach_get(pixels)
    colors = pixels.reshape(ROWS, 5, COLUMNS, 4)[..., :3].transpose(0, 2, 1, 3)
    answers = np.zeros((ROWS * COLUMNS, ANSWER), np.float32)
    answers[:, :15] = colors.reshape(-1, 15)
    (folder / "answers.f32").write_bytes(answers[:count].tobytes())


for name in sys.argv[1:]:
    run(Path(name))
print("Cycles of Blender", bpy.app.version_string)
