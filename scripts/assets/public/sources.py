"""The public scenes: repository, commit, path and licence of each, and what is done to it."""
import dataclasses

BEVY = ("bevyengine/bevy", "4805ca792c3e94eef07afd6fa9a2712f388c9a67",
        "MIT or Apache-2.0 (LICENSE-MIT, LICENSE-APACHE, CREDITS.md)")
GODOT = ("godotengine/godot-demo-projects", "cae8dc567a56d3e7936f171bcb85f0ccb9634ad0",
         "MIT (LICENSE.md)")
RENDERFORMER = ("microsoft/renderformer", "5b0b18f61de8fdc4a2c1caa0675181f3d88c90d6",
                "MIT (LICENSE)")
NORI = ("wjakob/nori", "092f581b8664cb7f6b7e73fb5b1e3de24365ea91",
        "unclear: for classrooms, no licence file")
TUTORIALS = ("mitsuba-renderer/mitsuba-tutorials", "a8dbee7e81b1039a983770ce1042f2d78688d0ae",
             "unclear: no licence file for cbox.xml")
MITSUBA = ("mitsuba-renderer/mitsuba-data", "01100fa9b0b154492061a92404f26dcd7b784dbb",
           "unclear: no licence file")
TUNGSTEN = ("tunabrain/tungsten", "88ea02044dbaf20472a8173b6752460b50c096d8",
            "zlib-like (LICENSE.txt)")


@dataclasses.dataclass(frozen=True)
class Source:
    name: str  # of the scene here
    origin: tuple  # repository, commit, licence
    path: str
    kind: str  # glb, xml, renderformer or tungsten
    scale: float = 1.0  # to metres
    camera: tuple = ()  # eye, target and vertical degrees, after scaling; () for the file's own
    lights: tuple = ()  # point lights of the project that the file lacks: place, W/sr a channel


# Godot's lamps are nodes of the demo, not of its .glb: 800 lm of 5000 K each, and an OmniLight3D.
BULB = (64.0, 58.0, 52.0)
SOURCES = [
    Source("bevy_cornell_box", BEVY, "assets/models/CornellBox/CornellBox.glb", "glb", 0.01,
           ((-2.78, 2.73, 13.5), (-2.78, 2.73, 0.0), 32.0)),
    Source("bevy_barred_room", BEVY, "assets/models/VolumetricFogExample/VolumetricFogExample.glb",
           "glb", 1.0, ((1.9, 1.7, 5.6), (-0.8, 1.6, -2.0), 60.0)),
    Source("godot_living_room", GODOT, "3d/physical_light_camera_units/living_room.glb", "glb", 1.0,
           ((-2.93, 2.2, -1.89), (0.9, 1.9, 1.6), 51.0),
           (((2.0, 3.19, 0.0), BULB), ((-2.0, 3.19, 0.0), BULB))),
    Source("godot_occlusion_room", GODOT, "3d/occlusion_culling_mesh_lod/room.glb", "glb", 1.0,
           ((0.0, 1.9, 4.3), (0.0, 1.5, -2.0), 70.0), (((0.0, 3.4, 0.0), (30.0, 30.0, 30.0)),)),
    *[Source(f"renderformer_{name}", RENDERFORMER, f"examples/{file}.json", "renderformer", 4.0)
      for name, file in (("cornell_box", "cbox"), ("cornell_bunny", "cbox-bunny"),
                         ("cornell_teapot", "cbox-teapot"), ("room", "room"),
                         ("crystals", "crystals"), ("shader_ball", "shader-ball"))],
    Source("nori_cornell_box", NORI, "scenes/pa5/cbox/cbox_mis.xml", "xml", 2.0),
    Source("mitsuba_tutorial_box", TUTORIALS, "scenes/cbox.xml", "xml", 2.0),
    Source("mitsuba_cornell_box", MITSUBA, "scenes/cbox/cbox.xml", "xml", 0.01),
    Source("tungsten_cornell_box", TUNGSTEN, "data/example-scenes/cornell-box/scene.json",
           "tungsten", 2.0),
]
