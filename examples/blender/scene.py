"""A scene in Blender whose surfaces are baked maps of upglow: lit by red, green, blue and ultraviolet.

    python scene.py FOLDER [--size PIXELS] [--samples COUNT] [--seed NUMBER] [--blend FILE]

with a Python that has Blender's package bpy, or in Blender itself:

    blender --background --python scene.py -- FOLDER

FOLDER holds, for each picture, `NAME.red.exr`, `NAME.green.exr`, `NAME.blue.exr` and
`NAME.ultraviolet.exr`: what leaves the surface of light that arrives as one of the four.
`lamps.json` has red, green, blue and ultraviolet of each lamp. `compare.py`
writes all of them. The render and its composite go to `render.exr` in FOLDER, the shapes, the camera and
the lamps for other renderers to `shapes.npz`. `--blend` also saves the scene.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix, Vector

INCIDENT = ("red", "green", "blue", "ultraviolet")
# Linear primaries of the maps, the lamps and the render.
SPACE = "ACEScg"

# Which picture covers which object.
PICTURES = {"floor": "pool", "wall": "white", "box": "chart", "globe": "bands", "ball": "white"}

# Where lamps are and where they point; strength is the scale of `lamps.json`. At a strength of 1, a
# lamp of the type SUN lights a white surface that faces it as its four numbers say; of the type AREA, a
# white surface that sees nothing but the lamp. The last number is the length of a side.
LAMPS = {
    "daylight": ("SUN", (1.6, -2.4, 3.6), (0, 0, 0), 1.0, None),
    "tungsten": ("AREA", (-2.6, -1.8, 2.4), (0, 0, 0.3), 16.0, 1.0),
    "ultraviolet": ("AREA", (2.2, -1.6, 2.6), (0, 0, 0.3), 22.0, 1.0),
}


def looking(at: Any, target: Any) -> Matrix:
    """Where a camera or lamp stands that looks at a target; Blender's look along −z, with y up."""
    direction = Vector(target) - Vector(at)
    return Matrix.Translation(at) @ direction.to_track_quat("-Z", "Y").to_matrix().to_4x4()


def empty_scene(size: int, samples: int, seed: int) -> Any:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.set_working_color_space(working_space=SPACE, convert_colors=False)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", samples, seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    # Every lamp at every point, in place of one chosen at random.
    cycles.use_light_tree = False
    # Light that meets one surface: what a matrix composites.
    cycles.max_bounces = 0
    cycles.sample_clamp_direct = 0.0
    cycles.pixel_filter_type = "BOX"
    scene.render.resolution_x, scene.render.resolution_y = size, size * 3 // 4
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = True
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit, camera.angle = "HORIZONTAL", math.radians(36)
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.camera.matrix_world = looking((0.4, -5.0, 2.3), (0.0, 0.0, 0.62))
    scene.collection.objects.link(scene.camera)
    return scene


def add_shapes(scene: Any) -> None:
    """A floor, a wall, a box, a globe and a white ball, all with texture coordinates."""
    bpy.ops.mesh.primitive_plane_add(size=4.4)
    bpy.context.object.name = "floor"
    bpy.ops.mesh.primitive_plane_add(size=4.4, location=(0, 2.2, 2.2), rotation=(math.pi / 2, 0, 0))
    bpy.context.object.name = "wall"
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.85, 0.45, 0.5), rotation=(0, 0, 0.5))
    box = bpy.context.object
    box.name = "box"
    # Every side shows the whole picture.
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)] * 6
    box.data.uv_layers[0].data.foreach_set("uv", np.array(corners, np.float32).ravel())
    for name, place, radius in (
        ("globe", (-0.75, 0.2, 0.75), 0.75),
        ("ball", (0.05, -1.0, 0.28), 0.28),
    ):
        bpy.ops.mesh.primitive_uv_sphere_add(
            segments=192, ring_count=96, radius=radius, location=place, rotation=(0, 0, 2.2)
        )
        bpy.context.object.name = name
        bpy.ops.object.shade_smooth()


def add_lamps(scene: Any, layer: Any, numbers: dict[str, list[float]]) -> None:
    """Each lamp twice: once with its red, green and blue, once with its ultraviolet in their place.

    Both have a light group of their own, so that one render holds what each of them brings.
    """
    for name, (kind, place, target, strength, side) in LAMPS.items():
        *rgb, ultraviolet = numbers[name]
        for twin, color in ((name, rgb), (f"{name}_u", [ultraviolet] * 3)):
            lamp = bpy.data.lights.new(twin, kind)
            # Blender keeps no negative color; the largest number goes to the strength.
            top = max(color)
            lamp.color = [max(value, 0.0) / top for value in color]
            if kind == "SUN":
                lamp.angle, lamp.energy = 0.0, math.pi * strength * top
            else:
                lamp.shape, lamp.size = "SQUARE", side
                # Watts: radiance times area, in all directions of one side.
                lamp.energy = math.pi * side**2 * strength * top
            node = bpy.data.objects.new(twin, lamp)
            node.matrix_world = looking(place, target)
            node.lightgroup = layer.lightgroups.add(name=twin).name
            scene.collection.objects.link(node)


def material(picture: str, folder: Path) -> Any:
    """White, so that the light passes are what arrives; its maps go to passes of their own."""
    made = bpy.data.materials.new(picture)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    white, surface = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    white.inputs["Color"].default_value = (1, 1, 1, 1)
    links.new(white.outputs["BSDF"], surface.inputs["Surface"])
    for row, incident in enumerate(INCIDENT):
        texture, output = nodes.new("ShaderNodeTexImage"), nodes.new("ShaderNodeOutputAOV")
        texture.image = bpy.data.images.load(str(folder / f"{picture}.{incident}.exr"))
        texture.image.colorspace_settings.name = "Non-Color"
        output.aov_name = incident
        links.new(texture.outputs["Color"], output.inputs["Color"])
        texture.location, output.location = (-400, -300 * row), (0, -300 * row)
    normal, output = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeOutputAOV")
    output.aov_name = "normal"
    links.new(normal.outputs["Normal"], output.inputs["Color"])
    normal.location, output.location = (-400, -1200), (0, -1200)
    white.location, surface.location = (-400, 200), (0, 200)
    return made


def matrix_group() -> Any:
    """A node group of the compositor: light times the maps, one after the other."""
    group = bpy.data.node_groups.new("upglow", "CompositorNodeTree")
    sockets = group.interface
    for name in ("light", "light's ultraviolet", *INCIDENT):
        sockets.new_socket(name, in_out="INPUT", socket_type="NodeSocketColor")
    sockets.new_socket("seen", in_out="OUTPUT", socket_type="NodeSocketColor")
    nodes, links = group.nodes, group.links
    inputs, outputs = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    light, ultraviolet = (nodes.new("CompositorNodeSeparateColor") for _ in range(2))
    links.new(inputs.outputs["light"], light.inputs["Image"])
    links.new(inputs.outputs["light's ultraviolet"], ultraviolet.inputs["Image"])
    arriving = [
        *(light.outputs[name] for name in ("Red", "Green", "Blue")),
        ultraviolet.outputs["Red"],
    ]
    inputs.location, outputs.location = (-800, 0), (800, 0)
    light.location, ultraviolet.location = (-500, 200), (-500, 0)
    seen = None
    for column, (incident, amount) in enumerate(zip(INCIDENT, arriving, strict=True)):
        add = nodes.new("ShaderNodeVectorMath")
        add.operation, add.location = "MULTIPLY_ADD", (250 * column - 250, 0)
        links.new(inputs.outputs[incident], add.inputs[0])
        links.new(amount, add.inputs[1])
        if seen is not None:
            links.new(seen, add.inputs[2])
        seen = add.outputs[0]
    links.new(seen, outputs.inputs["seen"])
    return group


def composite(scene: Any, folder: Path) -> None:
    """Writes what arrives and what is seen of each lamp, the maps, and the sum of all."""
    tree = scene.compositing_node_group = bpy.data.node_groups.new(
        "composite", "CompositorNodeTree"
    )
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    nodes, links, group = tree.nodes, tree.links, matrix_group()
    layer, file, shown = (
        nodes.new(kind)
        for kind in ("CompositorNodeRLayers", "CompositorNodeOutputFile", "NodeGroupOutput")
    )
    file.directory, file.file_name = str(folder), "render"
    file.format.media_type = "MULTI_LAYER_IMAGE"
    file.format.color_depth, file.format.use_exr_interleave = "32", True
    file.format.exr_codec = "ZIP"

    def keep(name: str, socket: Any) -> None:
        file.file_output_items.new("RGBA", name)
        links.new(socket, file.inputs[name])

    layer.location, file.location, shown.location = (-600, 0), (1000, -300), (1000, 0)
    total = None
    for row, name in enumerate(LAMPS):
        light, ultraviolet = (layer.outputs[f"Combined_{twin}"] for twin in (name, f"{name}_u"))
        seen = nodes.new("CompositorNodeGroup")
        seen.node_tree, seen.location = group, (-100, -300 * row)
        links.new(light, seen.inputs["light"])
        links.new(ultraviolet, seen.inputs["light's ultraviolet"])
        for incident in INCIDENT:
            links.new(layer.outputs[incident], seen.inputs[incident])
        for kind, socket in (
            ("light", light),
            ("ultraviolet", ultraviolet),
            ("seen", seen.outputs[0]),
        ):
            keep(f"{name}.{kind}", socket)
        if total is None:
            total = seen.outputs[0]
            continue
        add = nodes.new("ShaderNodeVectorMath")
        add.location = (250 * row, 0)
        links.new(total, add.inputs[0])
        links.new(seen.outputs[0], add.inputs[1])
        total = add.outputs[0]
    links.new(total, shown.inputs["Image"])
    for name in (*INCIDENT, "normal"):
        keep(f"map.{name}", layer.outputs[name])


def write_shapes(scene: Any, path: Path) -> None:
    """Triangles with normals and texture coordinates, the camera and the lamps, for other renderers."""
    found: dict[str, Any] = {
        "camera": np.array(scene.camera.matrix_world),
        "angle": scene.camera.data.angle,
    }
    for name in PICTURES:
        node = bpy.data.objects[name]
        mesh, world = node.data, np.array(node.matrix_world)
        mesh.calc_loop_triangles()
        corners = np.array([triangle.loops for triangle in mesh.loop_triangles]).ravel()
        vertices = np.array([loop.vertex_index for loop in mesh.loops])[corners]
        places = np.array([vertex.co for vertex in mesh.vertices])[vertices]
        normals = np.array([corner.vector for corner in mesh.corner_normals])[corners]
        found[f"{name}.places"] = places @ world[:3, :3].T + world[:3, 3]
        # Objects are moved and turned, and not stretched.
        found[f"{name}.normals"] = normals @ world[:3, :3].T
        found[f"{name}.uv"] = np.array([uv.uv for uv in mesh.uv_layers[0].data])[corners]
    for name, (_, _, _, strength, side) in LAMPS.items():
        found[f"{name}.lamp"] = np.array(bpy.data.objects[name].matrix_world)
        found[f"{name}.strength"], found[f"{name}.side"] = strength, side or 0.0
    np.savez(path, **found)


def main() -> None:
    typed = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="where the maps are, and the render goes")
    parser.add_argument("--size", type=int, default=256, help="width of the picture in pixels")
    parser.add_argument("--samples", type=int, default=256, help="samples per pixel")
    parser.add_argument("--seed", type=int, default=1, help="start of the random numbers")
    parser.add_argument("--blend", type=Path, help="file to save the scene in")
    options = parser.parse_args(typed)
    folder = options.folder.resolve()
    scene = empty_scene(options.size, options.samples, options.seed)
    layer = scene.view_layers[0]
    for name in (*INCIDENT, "normal"):
        layer.aovs.add().name = name
    add_shapes(scene)
    for name, picture in PICTURES.items():
        found = bpy.data.materials.get(picture) or material(picture, folder)
        bpy.data.objects[name].data.materials.append(found)
    add_lamps(scene, layer, json.loads((folder / "lamps.json").read_text()))
    composite(scene, folder)
    bpy.context.view_layer.update()
    write_shapes(scene, folder / "shapes.npz")
    if options.blend:
        bpy.ops.wm.save_as_mainfile(filepath=str(options.blend.resolve()))
    bpy.ops.render.render()
    print("Cycles of Blender", bpy.app.version_string, "wrote", folder / "render.exr")


if __name__ == "__main__":
    main()
