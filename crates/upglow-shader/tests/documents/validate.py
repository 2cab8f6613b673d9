"""Reads documents as MaterialX and USD do.

    validate.py materialx|usd DOCUMENT...

Each DOCUMENT is a path without its ending: `DOCUMENT.mtlx` and `DOCUMENT.usda`. `materialx` validates the former
and writes the shaders generated from it beside it: GLSL as `.frag` and `.vert`, OSL as `.osl` with the headers
that it includes. `usd` runs all validators of USD on the stages, and compares them with what MaterialX reads.
"""

import shutil
import sys
from pathlib import Path

import MaterialX as mx

# A renderer's own color space, None for that of the document.
WORKING_SPACES = [None, "lin_rec709_scene"]


def read(path):
    """The document, with the nodes that MaterialX knows."""
    library = mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    document = mx.createDocument()
    mx.readFromXmlFile(document, str(path.parent / (path.name + ".mtlx")))
    document.setDataLibrary(library)
    valid, message = document.validate()
    assert valid, message
    return document


def shaders(path, language):
    """The generated stages of each material, by the ending of their files."""
    from MaterialX import PyMaterialXGenGlsl, PyMaterialXGenOsl, PyMaterialXGenShader as gen

    document = read(path)
    endings = {"frag": gen.PIXEL_STAGE, "vert": gen.VERTEX_STAGE}
    generator = PyMaterialXGenGlsl.GlslShaderGenerator.create()
    if language == "osl":
        endings = {"osl": gen.PIXEL_STAGE}
        generator = PyMaterialXGenOsl.OslShaderGenerator.create()
    for space in WORKING_SPACES:
        context = gen.GenContext(generator)
        context.registerSourceCodeSearchPath(mx.getDefaultDataSearchPath())
        context.registerSourceCodeSearchPath(str(path.parent))
        if space is not None:
            context.getOptions().targetColorSpaceOverride = space
        generator.registerTypeDefs(document)
        colors = gen.DefaultColorManagementSystem.create(generator.getTarget())
        colors.loadLibrary(document)
        generator.setColorManagementSystem(colors)
        elements = gen.findRenderableElements(document)
        assert elements, path
        for element in elements:
            shader = generator.generate(element.getName(), element, context)
            for ending, stage in endings.items():
                name = f"{path.name}.{element.getName()}.{space}.{ending}"
                yield document, space, path.parent / name, shader.getSourceCode(stage)


def check_calls(document, space, path, text):
    """The generated code calls our function, before it the numbers are as they were given, and after it converted."""
    if path.suffix not in (".frag", ".osl"):
        return
    has_node = bool(document.getNodeDef("ND_upglow_color"))
    calls = [line.strip() for line in text.splitlines() if line.startswith("    upglow_color(")]
    assert len(calls) == int(has_node), (path, calls)
    assert all("color_rgb, color_out" in call for call in calls), calls
    if has_node and space and path.name.startswith("cube."):
        assert "acescg_to_lin_rec709_color3(color_out, " in text, path


def validate_materialx(paths):
    for path in paths:
        for language in "glsl", "osl":
            for document, space, file, text in shaders(path, language):
                check_calls(document, space, file, text)
                file.write_text(text)
    for header in Path(mx.__file__).parent.rglob("genosl/include/*.h"):
        shutil.copy(header, paths[0].parent)
    print("MaterialX", mx.getVersionString(), "made GLSL and OSL of", len(paths), "documents")


def check_shader(stage, document, shader):
    """The shader is a node that MaterialX knows, with the same inputs and color spaces."""
    from pxr import UsdShade

    definition = document.getNodeDef(shader.GetIdAttr().Get())
    if definition is None:
        definition = document.getDataLibrary().getNodeDef(shader.GetIdAttr().Get())
    assert definition is not None, shader.GetIdAttr().Get()
    types = {"filename": "asset", "color3": "color3f", "float": "float"}
    for given in shader.GetInputs():
        known = definition.getActiveInput(given.GetBaseName())
        assert known is not None, given.GetFullName()
        assert str(given.GetTypeName()) == types[known.getType()], given.GetFullName()
    material = UsdShade.Material(shader.GetPrim().GetParent()).GetPrim().GetName()
    graph = document.getNodeGraph("NG_" + material.removeprefix("M_"))
    node = graph.getNode(shader.GetPrim().GetName())
    if node is None:
        return
    for given in shader.GetInputs():
        named = node.getInput(given.GetBaseName())
        if given.GetTypeName() == "asset":
            assert given.Get().path == "./" + named.getValueString(), given.Get()
            assert given.GetAttr().GetColorSpace() == named.getColorSpace()


def validate_usd(paths):
    from pxr import Usd, UsdGeom, UsdShade, UsdValidation

    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    for path in paths:
        document = read(path)
        stage = Usd.Stage.Open(str(path.parent / (path.name + ".usda")))
        # The packaged USD knows no node of MaterialX; these are looked up in MaterialX itself.
        errors = UsdValidation.ValidationContext(validators).Validate(stage)
        errors = [error for error in errors if error.GetName() != "MissingShaderIdInRegistry"]
        assert not errors, [(error.GetName(), error.GetMessage()) for error in errors]
        shaders = [UsdShade.Shader(prim) for prim in stage.Traverse() if prim.IsA(UsdShade.Shader)]
        for shader in shaders:
            check_shader(stage, document, shader)
        shapes = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Gprim)]
        assert len(shapes) == len(document.getMaterialNodes()) > 0
        for shape in shapes:
            material, _ = UsdShade.MaterialBindingAPI(shape).ComputeBoundMaterial()
            surface, _, _ = material.ComputeSurfaceSource("mtlx")
            assert surface.GetIdAttr().Get() == "ND_open_pbr_surface_surfaceshader", shape
            extent = UsdGeom.Boundable(shape).GetExtentAttr().Get()
            computed = UsdGeom.Boundable.ComputeExtentFromPlugins(
                UsdGeom.Boundable(shape), Usd.TimeCode.Default()
            )
            assert list(extent) == list(computed), (extent, computed)
    print("USD", ".".join(map(str, Usd.GetVersion())), "read", len(paths), "stages")


validate = {"materialx": validate_materialx, "usd": validate_usd}
validate[sys.argv[1]]([Path(name).resolve() for name in sys.argv[2:]])
