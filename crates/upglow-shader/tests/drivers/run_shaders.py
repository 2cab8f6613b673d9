"""Runs compute shaders over queries, on the driver that Vulkan finds.

    run_shaders.py FOLDER...

Each folder holds a payload `shader.textures`, a shader `main.wgsl` or `main.spv` whose entry point
`main` answers one query an invocation, 64 to a group, and `queries.f32`, rows of 8 floats. The
answers, rows of 16 floats, go to `answers.f32`. Prints the driver's name.
"""

import struct
import sys
from pathlib import Path

import numpy as np
import wgpu

QUERY, ANSWER, GROUP, HEADER = 8, 16, 64, 64


def textures(payload):
    """Sizes and texels of the one or two textures of a payload, which is checked."""
    magic, version, _, *sizes = struct.unpack_from("<8s6I", payload)
    assert magic == b"UPGLOWTX" and version == 1, (magic, version)
    at = HEADER
    for width, height in zip(sizes[::2], sizes[1::2]):
        if width:
            yield width, height, payload[at : at + 16 * width * height]
            at += 16 * width * height
    assert at == len(payload), (at, len(payload))


def texture_view(device, width, height, texels):
    texture = device.create_texture(
        size=(width, height, 1),
        format="rgba32float",
        usage=wgpu.TextureUsage.TEXTURE_BINDING | wgpu.TextureUsage.COPY_DST,
    )
    device.queue.write_texture(
        {"texture": texture},
        texels,
        {"bytes_per_row": 16 * width, "rows_per_image": height},
        (width, height, 1),
    )
    return texture.create_view()


def run(device, folder):
    queries = np.fromfile(folder / "queries.f32", np.float32)
    count = queries.size // QUERY
    source = folder / "main.wgsl"
    code = source.read_text() if source.exists() else (folder / "main.spv").read_bytes()
    answers = device.create_buffer(
        size=4 * ANSWER * count, usage=wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_SRC
    )
    asked = device.create_buffer_with_data(data=queries, usage=wgpu.BufferUsage.STORAGE)
    layouts = [
        {"binding": 2, "buffer": {"type": "read-only-storage"}},
        {"binding": 3, "buffer": {"type": "storage"}},
    ]
    entries = [
        {"binding": 2, "resource": {"buffer": asked, "offset": 0, "size": asked.size}},
        {"binding": 3, "resource": {"buffer": answers, "offset": 0, "size": answers.size}},
    ]
    payload = (folder / "shader.textures").read_bytes()
    for binding, texture in enumerate(textures(payload)):
        sampled = {"sample_type": "unfilterable-float", "view_dimension": "2d"}
        layouts.append({"binding": binding, "texture": sampled})
        entries.append({"binding": binding, "resource": texture_view(device, *texture)})
    for layout in layouts:
        layout["visibility"] = wgpu.ShaderStage.COMPUTE
    layout = device.create_bind_group_layout(entries=layouts)
    group = device.create_bind_group(layout=layout, entries=entries)
    pipeline = device.create_compute_pipeline(
        layout=device.create_pipeline_layout(bind_group_layouts=[layout]),
        compute={"module": device.create_shader_module(code=code), "entry_point": "main"},
    )
    encoder = device.create_command_encoder()
    compute = encoder.begin_compute_pass()
    compute.set_pipeline(pipeline)
    compute.set_bind_group(0, group)
    compute.dispatch_workgroups(-(-count // GROUP))
    compute.end()
    device.queue.submit([encoder.finish()])
    (folder / "answers.f32").write_bytes(device.queue.read_buffer(answers))


def driver():
    """The first adapter of Vulkan, in software where there is a choice."""
    adapters = [a for a in wgpu.gpu.enumerate_adapters_sync() if a.info["backend_type"] == "Vulkan"]
    return min(adapters, key=lambda a: a.info["adapter_type"] != "CPU", default=None)


adapter = driver()
if adapter is None:
    sys.exit("no Vulkan driver")
device = adapter.request_device_sync()
for name in sys.argv[1:]:
    run(device, Path(name))
print(adapter.info["device"], adapter.info["description"])
