#include "lte/scene/import/environment_file.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "lte/base/check.h"
#include "lte/image/picture.h"
#include "lte/image/tonemap.h"
#include "lte/scene/number_check.h"

namespace lte::scene {
namespace {

/// Three numbers between commas; nothing for anything else.
std::optional<Rgb> parse_rgb(std::string_view text) {
  Rgb out;
  for (int c = 0; c < 3; ++c) {
    const std::string_view field = text.substr(0, c < 2 ? text.find(',') : text.size());
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), out[c]);
    if (error != std::errc() || end != field.data() + field.size()) return std::nullopt;
    if (c < 2 && field.size() == text.size()) return std::nullopt;
    text.remove_prefix(std::min(text.size(), field.size() + 1));
  }
  return out;
}

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
  if (const std::optional<Rgb> constant = parse_rgb(text)) {
    LTE_CHECK(is_finite(*constant) && constant->x >= 0 && constant->y >= 0 && constant->z >= 0,
              "environment ", text, ": radiance must be finite and not negative");
    environment.radiance = *constant;
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
