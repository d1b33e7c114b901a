#include "datagen/homes/home.h"

#include <algorithm>

#include "datagen/common/daylight.h"
#include "datagen/homes/cameras.h"
#include "datagen/homes/furnish.h"
#include "datagen/homes/kit.h"
#include "datagen/homes/lights.h"
#include "datagen/homes/shell.h"
#include "datagen/homes/stage.h"
#include "datagen/homes/sun.h"

namespace lte::datagen::homes {
namespace {

bool has_window(const FloorPlan& plan) {
  return std::any_of(plan.openings.begin(), plan.openings.end(),
                     [](const Opening& o) { return o.kind == OpeningKind::Window; });
}

}  // namespace

Home generate_home(const HomeConfig& config, uint64_t seed, const std::string& name) {
  Home home;
  home.scene.name = name;
  Rng rng(seed, 0x686f6d65ULL);
  Palette palette(&home.scene, config.texture_sizes, seed);
  const auto rooms = config.rooms.low + static_cast<int64_t>(rng.below(static_cast<uint64_t>(
                                            config.rooms.high - config.rooms.low + 1)));
  const float height = rng.uniform(static_cast<float>(config.height_m.low),
                                   static_cast<float>(config.height_m.high));
  home.plan.floor = make_floor_plan(static_cast<int>(rooms), height, &rng);

  Kit kit{&palette,
          Rng(rng.next_u64()),
          {log_uniform(config.detail, &rng)},
          log_uniform(config.radiance, &rng),
          static_cast<float>(config.lit_share)};
  const bool daylight = rng.uniform() < config.daylight_share && has_window(home.plan.floor);
  const float sky = daylight ? 0.6f * kit.radiance * rng.uniform(0.5f, 1.5f) : 0.0f;

  const Rgb sky_radiance = light_tint(rng.uniform(0, 0.35f)) * sky;
  Rng sun_rng(seed, 0x73756eULL);  // of its own: homes without suns are what they always were
  const bool sunny = daylight && sun_rng.uniform() < config.sun_share;

  Stage stage(&home);
  build_shell(&stage, &kit);
  build_openings(&stage, &kit, sunny ? Windows::Open : Windows::Panes, sky_radiance);
  place_ceiling_lights(&stage, &kit, daylight);
  for (int room = 0; room < static_cast<int>(home.plan.floor.rooms.size()); ++room)
    Furnisher(&stage, &kit, room, static_cast<float>(config.clutter)).furnish();
  if (sunny) add_sun_and_sky(&stage, &kit, sky_radiance, config.sky_picture_share, &sun_rng);
  home.scene.cameras = room_cameras(home.plan);
  return home;
}

}  // namespace lte::datagen::homes
