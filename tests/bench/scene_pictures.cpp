// Scenes of a generator, seen by their own cameras: what scripts/figures/scene_pictures.py makes
// the pictures of docs/dataset.md from.
//
// usage: lte_scene_pictures CONFIG.yaml FOLDER [COUNT] [PATHS_A_PIXEL] [WIDTH OF A VIEW] writes
// FOLDER/NNN_{color,albedo,normal}.pfm, linear. Homes show so many rooms of each kind; of other
// scenes one camera each is taken.
#include <cstdio>
#include <cstdlib>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "datagen/dataset/dataset_folder.h"
#include "datagen/dataset/generate.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/text.h"
#include "lte/image/image.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"
#include "lte/pathtrace/render.h"

namespace {

using namespace lte;

/// How many views there are of each kind of room.
std::map<std::string, int> wanted() {
  return {{"living room", 4}, {"bedroom", 3},     {"kitchen", 3},
          {"bathroom", 2},    {"dining room", 2}, {"study", 2}};
}

/// Of a room of which there are still too few views; null if the home has none.
const scene::Camera* camera_of(const scene::Scene& scene, std::map<std::string, int>* left) {
  const scene::Camera* best = nullptr;
  for (const scene::Camera& camera : scene.cameras) {
    const int wants = (*left)[camera.name];
    if (wants > 0 && (best == nullptr || wants > (*left)[best->name])) best = &camera;
  }
  if (best != nullptr) --(*left)[best->name];
  return best;
}

/// Portable float map: rows from the bottom, little-endian.
void write_pfm(const std::string& path, const image::Image& image) {
  std::string bytes = concat("PF\n", image.width, " ", image.height, "\n-1.0\n");
  for (int y = image.height; y-- > 0;)
    bytes.append(reinterpret_cast<const char*>(image.at(0, y)),
                 sizeof(float) * 3 * static_cast<size_t>(image.width));
  write_file(path, bytes);
}

image::Image as_image(std::span<const Vec3> values, int width, int height) {
  image::Image out(width, height, 3);
  for (size_t i = 0; i < values.size(); ++i)
    for (int c = 0; c < 3; ++c) out.pixels[3 * i + static_cast<size_t>(c)] = values[i][c];
  return out;
}

void render(const scene::Scene& scene, const scene::Camera& camera, int width, int height,
            int paths, const std::string& stem) {
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  pathtrace::RenderOptions options;
  options.spp = paths;
  options.max_depth = 9;
  const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(bvh, camera, width, height);
  write_pfm(stem + "albedo.pfm", as_image(hits.albedo, width, height));
  write_pfm(stem + "normal.pfm", as_image(hits.normal, width, height));
  write_pfm(stem + "color.pfm",
            pathtrace::render_reference(bvh, lights, camera, width, height, options));
}

/// The cameras of other scenes in turn.
const scene::Camera* next_camera(const scene::Scene& scene, int64_t index) {
  if (scene.cameras.empty()) return nullptr;
  return &scene.cameras[static_cast<size_t>(index) % scene.cameras.size()];
}

void run(const std::string& file, const std::string& folder, int count, int paths, int width) {
  const datagen::DatagenConfig config = datagen::load_datagen_config(file);
  const bool homes = config.generator == datagen::GeneratorKind::Homes;
  const int height = homes ? width * 9 / 16 : width * 3 / 4;
  make_directory(folder);
  std::map<std::string, int> left = wanted();
  int i = 0;
  for (int64_t next = 0; i < count; ++next) {
    const scene::Scene scene =
        datagen::generate_scene(config, datagen::scene_seed(config.seed, next),
                                formatted("%lld", static_cast<long long>(next)));
    const scene::Camera* camera = homes ? camera_of(scene, &left) : next_camera(scene, next);
    if (camera == nullptr) continue;
    std::printf("%d: scene %lld, %s, %lld triangles\n", i, static_cast<long long>(next),
                camera->name.c_str(), static_cast<long long>(scene.triangle_count()));
    std::fflush(stdout);
    render(scene, *camera, width, height, paths, formatted("%s/%03d_", folder.c_str(), i));
    ++i;
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    LTE_CHECK(argc >= 3 && argc <= 6,
              "usage: lte_scene_pictures CONFIG.yaml FOLDER [COUNT] [PATHS_A_PIXEL] [WIDTH]");
    run(argv[1], argv[2], argc > 3 ? std::atoi(argv[3]) : 16, argc > 4 ? std::atoi(argv[4]) : 64,
        argc > 5 ? std::atoi(argv[5]) : 400);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lte_scene_pictures: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
