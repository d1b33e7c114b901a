// The picture of docs/dataset.md: rooms of the generator `homes`, seen by their own cameras.
//
// usage: lte_home_pictures OUT.png [PATHS_A_PIXEL] [WIDTH OF A VIEW] [FIRST SCENE]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "datagen/homes/home.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights.h"
#include "lte/pathtrace/render.h"

namespace {

using namespace lte;

constexpr int kColumns = 4, kRows = 4;
/// What each view is to show, row by row.
constexpr std::array<const char*, kColumns* kRows> kWanted = {
    "living room", "bedroom",     "kitchen",     "bathroom",     //
    "dining room", "study",       "living room", "bedroom",      //
    "kitchen",     "living room", "bathroom",    "dining room",  //
    "bedroom",     "study",       "living room", "kitchen"};

const scene::Camera* camera_of(const scene::Scene& scene, const std::string& room) {
  for (const scene::Camera& camera : scene.cameras)
    if (camera.name == room) return &camera;
  return nullptr;
}

image::Image render(const scene::Scene& scene, const scene::Camera& camera, int width, int height,
                    int paths) {
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  pathtrace::RenderOptions options;
  options.spp = paths;
  options.max_depth = 9;
  const image::Image linear =
      pathtrace::render_reference(bvh, lights, camera, width, height, options);
  return image::tonemap(linear, image::auto_exposure(linear, 0.75f, 0.6f));
}

void paste(const image::Image& view, int x0, int y0, image::Image* sheet) {
  for (int y = 0; y < view.height; ++y)
    std::copy_n(view.at(0, y), 3 * view.width, sheet->at(x0, y0 + y));
}

void run(const std::string& out, int paths, int width, int64_t next) {
  const int height = width * 9 / 16;
  image::Image sheet(kColumns * width, kRows * height, 3);
  const datagen::homes::HomeConfig config;
  for (size_t i = 0; i < kWanted.size(); ++i) {
    for (;; ++next) {  // the next home that has such a room
      const datagen::homes::Home home =
          datagen::homes::generate_home(config, hash_combine(1, static_cast<uint64_t>(next)));
      const scene::Camera* camera = camera_of(home.scene, kWanted[i]);
      if (camera == nullptr) continue;
      std::printf("%zu: scene %lld, %s, %lld triangles\n", i, static_cast<long long>(next++),
                  kWanted[i], static_cast<long long>(home.scene.triangle_count()));
      std::fflush(stdout);
      const auto column = static_cast<int>(i) % kColumns, row = static_cast<int>(i) / kColumns;
      paste(render(home.scene, *camera, width, height, paths), column * width, row * height,
            &sheet);
      break;
    }
  }
  image::write_png(out, sheet);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    LTE_CHECK(argc >= 2 && argc <= 5,
              "usage: lte_home_pictures OUT.png [PATHS_A_PIXEL] [WIDTH] [FIRST SCENE]");
    run(argv[1], argc > 2 ? std::atoi(argv[2]) : 256, argc > 3 ? std::atoi(argv[3]) : 320,
        argc > 4 ? std::atoll(argv[4]) : 0);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "lte_home_pictures: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
