#include "lte/scene/import/environment_file.h"

#include <cmath>
#include <filesystem>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/to_number.h"
#include "lte/image/picture.h"
#include "lte/image/tonemap.h"
#include "lte/scene/number_check.h"

namespace lte::scene {
namespace {

std::shared_ptr<const EnvironmentMap> read_map(const std::string& path) {
  image::Picture picture = image::read_picture(path, EnvironmentMap::kMaxTexels);
  for (float& value : picture.image.pixels) {
    if (picture.coded) value = image::srgb_to_linear(value);
    if (value < 0) value = 0;
  }
  try {
    return std::make_shared<const EnvironmentMap>(picture.image, SphereMapping::Equirectangular);
  } catch (const Error& error) {
    throw Error(concat(path, ": ", error.what()));
  }
}

}  // namespace

void add_environment_group(Scene* scene) {
  if (!scene->environment || scene->environment->light_group != kNone) return;
  scene->environment->light_group = static_cast<int>(scene->light_groups.size());
  scene->light_groups.emplace_back("environment");
}

void set_environment(const std::string& text, double turn_degrees, Scene* scene) {
  Environment environment;
  if (const auto rgb = to_numbers<float, 3>(text, ',')) {
    const Rgb constant{(*rgb)[0], (*rgb)[1], (*rgb)[2]};
    LTE_CHECK(is_finite(constant) && constant.x >= 0 && constant.y >= 0 && constant.z >= 0,
              "environment ", text, ": radiance must be finite and not negative");
    environment.radiance = constant;
  } else {
    LTE_CHECK(std::filesystem::exists(text), "environment ", text,
              ": neither three numbers R,G,B nor a file that is there");
    environment.radiance = {1, 1, 1};
    environment.map = read_map(text);
  }
  check_environment(concat("environment ", text), environment);
  LTE_CHECK(std::isfinite(turn_degrees),
            "environment: its turn must be a finite number of degrees, got ", turn_degrees);
  // The frame of a picture has Y up, so that a turn is about the world's Y.
  const double angle = turn_degrees * (M_PI / 180);
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  environment.axes = {{{c, 0, -s}, {0, 1, 0}, {s, 0, c}}};
  if (scene->environment) environment.light_group = scene->environment->light_group;
  scene->environment = std::move(environment);
  add_environment_group(scene);
}

}  // namespace lte::scene
