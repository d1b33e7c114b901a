// Rooms of the generator `homes`, seen by their own cameras: what scripts/figures/home_pictures.py
// makes the picture of docs/dataset.md from.
//
// usage: lte_home_pictures FOLDER [PATHS_A_PIXEL] [WIDTH OF A VIEW] [FIRST SCENE] writes
// FOLDER/NN_{color,albedo,normal}.pfm, linear
#include <cstdio>
#include <cstdlib>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "datagen/homes/home.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/random.h"
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

void run(const std::string& folder, int paths, int width, int64_t next) {
  const int height = width * 9 / 16;
  const datagen::homes::HomeConfig config;
  make_directory(folder);
  std::map<std::string, int> left = wanted();
  int views = 0, i = 0;
  for (const auto& [name, count] : left) views += count;
  for (; i < views; ++next) {
    const datagen::homes::Home home =
        datagen::homes::generate_home(config, hash_combine(1, static_cast<uint64_t>(next)));
    const scene::Camera* camera = camera_of(home.scene, &left);
    if (camera == nullptr) continue;
    std::printf("%d: scene %lld, %s, %lld triangles\n", i, static_cast<long long>(next),
                camera->name.c_str(), static_cast<long long>(home.scene.triangle_count()));
    std::fflush(stdout);
    render(home.scene, *camera, width, height, paths,
           concat(folder, "/", i < 10 ? "0" : "", i, "_"));
    ++i;
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    LTE_CHECK(argc >= 2 && argc <= 5,
              "usage: lte_home_pictures FOLDER [PATHS_A_PIXEL] [WIDTH] [FIRST SCENE]");
    run(argv[1], argc > 2 ? std::atoi(argv[2]) : 64, argc > 3 ? std::atoi(argv[3]) : 400,
        argc > 4 ? std::atoll(argv[4]) : 0);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lte_home_pictures: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
