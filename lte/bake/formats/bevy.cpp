#include "lte/bake/formats/engine_scene.h"
#include "lte/bake/formats/formats.h"
#include "lte/bake/formats/probe_files.h"
#include "lte/base/text.h"
#include "lte/image/ktx2.h"

namespace lte::bake {
namespace {

constexpr const char* kBevyReadme = R"(Light map of {{source}} for Bevy (feature "ktx2").

Copy this folder to assets/baked and spawn scene.glb#Scene0. UV_1 is the place in the atlas itself,
so that every mesh takes the whole map; lightmap.json has the rectangle of each.
Values are E / pi in W/sr/m2: 998 is what the default camera exposure (EV100 9.7) divides by.

    fn add_light_map(mut commands: Commands, assets: Res<AssetServer>,
                     meshes: Query<(Entity, &MeshMaterial3d<StandardMaterial>), Added<Mesh3d>>,
                     mut materials: ResMut<Assets<StandardMaterial>>) {
        let image = assets.load("baked/lightmap.ktx2");
        for (entity, material) in &meshes {
            if let Some(found) = materials.get_mut(&material.0) { found.lightmap_exposure = 998.0; }
            commands.entity(entity).insert(Lightmap { image: image.clone(),
                uv_rect: Rect::new(0.0, 0.0, 1.0, 1.0), bicubic_sampling: false });
        }
    }
)";

constexpr const char* kBevyVolume = R"(
What moves is lit by irradiance_volume.ktx2:

    let voxels = assets.load("baked/irradiance_volume.ktx2");
    commands.spawn((LightProbe::default(),
        IrradianceVolume { voxels, intensity: 998.0, ..default() },
        Transform::from_translation({{center}}).with_scale({{extent}})));
)";

std::string rust_vector(const Vec3& v) {
  return formatted("Vec3::new(%.7g_f32, %.7g_f32, %.7g_f32)", v.x, v.y, v.z);
}

}  // namespace

void write_bevy(const Lightmap& map, const FormatOptions& options, FileSet* files) {
  files->write("lightmap.ktx2", [&](const std::filesystem::path& path) {
    image::write_ktx2(path, {image::Ktx2Format::Rgb9e5, map.width, map.height, /*depth=*/0,
                             /*layers=*/0, radiosity(map)});
  });
  std::string readme = filled(kBevyReadme, {{"source", map.provenance.source}});
  if (options.probes != nullptr) {
    files->write("irradiance_volume.ktx2", [&](const std::filesystem::path& path) {
      image::write_ktx2(path, bevy_volume(*options.probes));
    });
    const Bounds& bounds = options.probes->grid.bounds;
    readme += filled(kBevyVolume, {{"center", rust_vector(bounds.center())},
                                   {"extent", rust_vector(bounds.extent())}});
  }
  files->write("README.txt", readme);
  write_scene_and_record(map, "lightmap.ktx2", kRadiosityUnits, files);
}

}  // namespace lte::bake
