#include "lte/cli/scene_flags.h"

#include <array>
#include <cmath>

#include <CLI/CLI.hpp>

#include "lte/base/text.h"
#include "lte/scene/import/limit_error.h"
#include "lte/scene/import/limits.h"
#include "lte/scene/load.h"

namespace lte {
namespace {

/// A value for --limits that is enough, of two digits: "1.3G" of 1,280,000,000.
std::string enough(int64_t needed) {
  constexpr std::array<const char*, 5> kUnits = {"", "k", "M", "G", "T"};
  double value = static_cast<double>(needed);
  size_t unit = 0;
  for (; value >= 1000 && unit + 1 < kUnits.size(); value /= 1000) ++unit;
  const double step = unit == 0 ? 1 : value < 10 ? 0.1 : value < 100 ? 1 : 10;
  return formatted("%g%s", std::ceil(value / step - 1e-9) * step, kUnits[unit]);
}

}  // namespace

void add_scene_flags(CLI::App& app, SceneFlags* flags) {
  const char* group = "Scenes of others";
  app.add_flag("--allow-outside", flags->allow_outside,
               "Also read what the scene names outside the folder of its file: textures in ../, "
               "links that lead elsewhere")
      ->group(group);
  const auto check = [](const std::string& text) {
    try {
      scene::parse_limits(text);
      return std::string();
    } catch (const Error& error) {
      return std::string(error.what());
    }
  };
  app.add_option("--limits", flags->limits,
                 "Caps on what the scene may take, such as pictures=4GB,inflated=2GB (by default "
                 "1GB each); triangles, pixels, text and includes have one, too")
      ->check(CLI::Validator(check, "NAME=VALUE,..."))
      ->group(group);
}

scene::Scene load_scene(const std::filesystem::path& path, const SceneFlags& flags) try {
  scene::LoadLimits limits = scene::parse_limits(flags.limits);
  limits.outside = flags.allow_outside;
  return scene::load_scene(path, limits);
} catch (const scene::OutsideFolder& refusal) {
  throw Error(concat(refusal.what(), " (--allow-outside)"));
} catch (const scene::OverLimit& refusal) {
  throw Error(concat(refusal.what(), " (--limits ", refusal.limit(), "=",
                     refusal.needed() > 0 ? enough(refusal.needed()) : "SIZE", ")"));
}

}  // namespace lte
