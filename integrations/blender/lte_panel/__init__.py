"""A panel in Blender's render properties that renders the scene by lte and shows the picture.

Needs the Python package in Blender's own Python: python -m pip install lte-*.whl
"""
import bpy
import numpy as np

bl_info = {"name": "lte", "author": "The lte authors", "version": (0, 2, 0), "blender": (4, 2, 0),
           "location": "Properties > Render > lte", "category": "Render",
           "description": "Global illumination without a GPU"}


class Settings(bpy.types.PropertyGroup):
    quality: bpy.props.EnumProperty(
        name="Quality", default="preview",
        items=[(word, word.capitalize(), "") for word in ("draft", "preview", "final")])


class Render(bpy.types.Operator):
    """Renders the scene by lte into the image "lte"."""
    bl_idname = "lte.render"
    bl_label = "Render"

    def execute(self, context):
        try:
            import lte
        except ImportError as problem:
            self.report({"ERROR"}, f"lte is not in Blender's Python: {problem}")
            return {"CANCELLED"}
        render = context.scene.render
        size = [max(1, side * render.resolution_percentage // 100)
                for side in (render.resolution_x, render.resolution_y)]
        try:
            scene = lte.from_blender(context.evaluated_depsgraph_get())
            camera = context.scene.camera
            picture = lte.render(scene, size=size, quality=context.scene.lte.quality,
                                 camera=camera.name if camera else "auto")
        except (lte.Error, ValueError) as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        show(picture.color)
        return {"FINISHED"}


def show(color):
    """In the image "lte", and in image editors that show no other; rows of Blender go up."""
    height, width = color.shape[:2]
    image = bpy.data.images.get("lte")
    if image is None or tuple(image.size) != (width, height):
        if image is not None:
            bpy.data.images.remove(image)
        image = bpy.data.images.new("lte", width, height, float_buffer=True)
    pixels = np.ones((height, width, 4), np.float32)
    pixels[:, :, :3] = color[::-1]
    image.pixels.foreach_set(pixels.reshape(-1))
    image.update()
    for area in (bpy.context.screen.areas if bpy.context.screen else ()):
        if area.type == "IMAGE_EDITOR" and area.spaces.active.image in (None, image):
            area.spaces.active.image = image


class Panel(bpy.types.Panel):
    bl_idname = "RENDER_PT_lte"
    bl_label = "lte"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"

    def draw(self, context):
        self.layout.prop(context.scene.lte, "quality")
        self.layout.operator("lte.render")


CLASSES = (Settings, Render, Panel)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.lte = bpy.props.PointerProperty(type=Settings)


def unregister():
    del bpy.types.Scene.lte
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
