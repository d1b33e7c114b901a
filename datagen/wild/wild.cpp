#include "datagen/wild/wild.h"

#include <algorithm>
#include <cmath>

#include "datagen/homes/kit.h"
#include "datagen/homes/palette.h"
#include "datagen/wild/cameras.h"
#include "datagen/wild/furnishing.h"
#include "datagen/wild/lamps.h"
#include "datagen/wild/openings.h"
#include "datagen/wild/shell.h"
#include "datagen/wild/sky.h"
#include "datagen/wild/structure.h"
#include "lte/base/check.h"
#include "lte/pathtrace/bvh.h"
#include "lte/scene/light_points.h"

namespace lte::datagen::wild {
namespace {

constexpr uint64_t kStream = 0x77696c64;  // "wild"

/// One draw of a scene, step by step; the order of the steps is the order of the random draws.
class WildMaker {
 public:
  WildMaker(const WildConfig& config, uint64_t seed, const std::string& name)
      : config_(config), seed_(seed), dice_{Rng(seed, kStream)} {
    wild_.scene.name = name;
  }

  /// @return  why it is not taken, or nothing
  std::string make(Wild* out) {
    lay_out();
    build();
    move_to_world();
    if (wild_.scene.triangle_count() > kMaxTriangles) return "too many triangles";
    const pathtrace::Bvh bvh(wild_.scene);
    wild_.scene.cameras = place_cameras(wild_.plan.plan, wild_.plan.to_world, bvh, &dice_);
    std::string fault = check_scene(bvh, seed_, &wild_.scene);
    if (fault.empty()) *out = std::move(wild_);
    return fault;
  }

 private:
  void lay_out();
  void build();
  void light(Builder* builder, homes::Kit* kit);
  void move_to_world();
  int lamp_count();

  const WildConfig& config_;
  uint64_t seed_;
  Dice dice_;
  Wild wild_;
  float extent_ = 0;
  bool furnace_ = false;
};

void WildMaker::lay_out() {
  extent_ = log_uniform(config_.extent_m, &dice_.rng);
  const int low = static_cast<int>(config_.cells.low), high = static_cast<int>(config_.cells.high);
  const int most = dice_.count(low, high);
  furnace_ = low == 1 && dice_.chance(kShares.furnace);
  wild_.plan.sky = !furnace_ && dice_.chance(static_cast<float>(config_.sky_share));
  const float cells = furnace_ ? 1 : static_cast<float>(most);
  const float unit = std::clamp(0.7f * extent_ / std::sqrt(cells), 1.8f, 6.5f);
  Plan& plan = wild_.plan.plan;
  plan = make_plan(furnace_ ? 1 : low, furnace_ ? 1 : most, unit, &dice_);
  if (furnace_) {
    plan.cells.resize(1);
    plan.links.clear();
    Ceiling& ceiling = plan.cells[0].ceiling;
    if (ceiling.kind == CeilingKind::None) ceiling.kind = CeilingKind::Flat;
    return;
  }
  cut_openings(wild_.plan.sky, &plan, &dice_);
}

/// Six tenths of the scenes have one to three lamps, half of the others four to twelve.
int WildMaker::lamp_count() {
  const float kind = dice_.draw(0, 1), rest = 0.5f * (1 - kShares.one_to_three);
  const int count = kind < kShares.one_to_three          ? dice_.count(1, 3)
                    : kind < kShares.one_to_three + rest ? dice_.count(4, 12)
                                                         : dice_.count(13, 40);
  return std::clamp(count, static_cast<int>(config_.lamps.low),
                    static_cast<int>(config_.lamps.high));
}

void WildMaker::build() {
  Materials materials(&wild_.scene, config_.texture_sizes, seed_);
  homes::Palette palette(&wild_.scene, config_.texture_sizes, seed_);
  homes::Kit kit{
      &palette, Rng(dice_.rng.next_u64()), {log_uniform(config_.detail, &dice_.rng)}, 1, 1};
  Builder builder(&wild_.scene, &wild_.plan.plan, &materials);
  int emitter = scene::kNone;
  if (furnace_) {
    builder.next_group();
    emitter = materials.emitter("furnace", materials.lamp_color(&dice_), false);
    builder.lamps.push_back({LampKind::Shell, {}, {}, 0});
  }
  build_shell(&builder, &dice_, emitter);
  build_structure(&builder, &dice_);
  if (!furnace_) light(&builder, &kit);
  builder.group = scene::kNone;
  kit.lit_share = 0;
  furnish(&builder, &kit, &dice_);
  for (const Lamp& lamp : builder.lamps) wild_.plan.lamps.push_back(lamp.kind);
  wild_.plan.closed = !is_open(wild_.plan.plan);
}

void WildMaker::light(Builder* builder, homes::Kit* kit) {
  Plan& plan = wild_.plan.plan;
  wild_.plan.sky = wild_.plan.sky && is_open(plan);
  const bool lamps = !wild_.plan.sky || dice_.chance(kShares.lamps_under_sky);
  if (lamps) place_lamps(lamp_count(), builder, kit, &dice_);
  const float watts = plan.floor_area() * dice_.log_draw(kShares.power_m2[0], kShares.power_m2[1]);
  set_powers(watts, builder, &dice_);
  if (!wild_.plan.sky) {
    close_windows(builder, &dice_);
  } else if (is_open(plan)) {
    add_sky_and_sun(builder, &dice_);
  } else {
    wild_.plan.sky = false;  // lamps took all of the windows
  }
}

/// Turns the scene about y and brings its longest side to the extent that was drawn. Under a sky
/// that is the diameter of the sphere around it, on which the sky's points lie.
void WildMaker::move_to_world() {
  scene::Scene& scene = wild_.scene;
  const float angle = dice_.chance(kShares.turned) ? dice_.draw(0, 2 * kPi) : 0;
  const Affine turn = standing({}, 0, angle);
  const auto apply = [&](const Affine& move, float scale) {
    for (scene::Instance& instance : scene.instances) instance.to_world = move * instance.to_world;
    for (scene::PunctualLight& light : scene.lights) {
      light.position = move.point(light.position);
      light.direction = normalize(move.vector(light.direction));
      if (light.kind != scene::LightKind::Directional) light.intensity *= scale * scale;
    }
  };
  apply(turn, 1);
  const Vec3 size = scene.bounds().extent();
  const float now = wild_.plan.sky ? length(size) : max_component(size);
  const float scale = extent_ / now;
  const Affine grow = homes::scaling({scale, scale, scale});
  apply(grow, scale);
  wild_.plan.to_world = grow * turn;
  if (scene.environment) {
    for (Vec3& axis : scene.environment->axes) axis = turn.vector(axis);
  }
}

}  // namespace

Wild generate_wild(const WildConfig& config, uint64_t seed, const std::string& name) {
  std::vector<std::string> rejected;
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const uint64_t own = draw == 0 ? seed : hash_combine(seed, static_cast<uint64_t>(draw));
    Wild wild;
    std::string fault = WildMaker(config, own, name).make(&wild);
    if (fault.empty()) {
      wild.plan.rejected = std::move(rejected);
      return wild;
    }
    rejected.push_back(std::move(fault));
  }
  throw Error(concat(name, ": ", kMaxDraws, " draws of seed ", seed,
                     " failed, the last one by: ", rejected.back()));
}

}  // namespace lte::datagen::wild
