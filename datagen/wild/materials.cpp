#include "datagen/wild/materials.h"

#include <algorithm>

#include "datagen/common/daylight.h"
#include "datagen/common/textures.h"
#include "datagen/wild/shares.h"

namespace lte::datagen::wild {
namespace {

constexpr uint64_t kMaterialStream = 0x77696c646d;  // "wildm"
constexpr size_t kMaxThings = 8;

Rgb hue_color(float hue, float saturation, float value) {
  const auto channel = [&](float offset) {
    const float t = std::abs(fraction(hue + offset) * 6 - 3) - 1;
    return 1 - saturation * (1 - std::clamp(t, 0.0f, 1.0f));
  };
  return Rgb{channel(0), channel(2.0f / 3), channel(1.0f / 3)} * value;
}

}  // namespace

Materials::Materials(scene::Scene* scene, std::vector<int64_t> texture_sizes, uint64_t seed)
    : scene_(scene),
      sizes_(std::move(texture_sizes)),
      dice_{Rng(seed, kMaterialStream)},
      key_(dice_.pick(kShares.keys)),
      muted_(dice_.chance(kShares.muted)) {}

/// The value of the brightest channel is uniform in the range of the scene's key.
Rgb Materials::color() {
  const float* range = kShares.albedo[key_];
  const float value = dice_.draw(range[0], range[1]);
  const float saturation = muted_                            ? dice_.draw(0, 0.2f)
                           : dice_.chance(kShares.saturated) ? dice_.draw(0.5f, 1)
                                                             : dice_.draw(0, 0.4f);
  return clamp_albedo(hue_color(dice_.draw(0, 1), saturation, value), {0.02f, 0.97f});
}

int Materials::add(const std::string& name, const Rgb& color) {
  scene::Material material;
  material.name = name;
  material.base_color = color;
  scene_->materials.push_back(material);
  return static_cast<int>(scene_->materials.size()) - 1;
}

TexturePtr Materials::pattern() {
  const int size = static_cast<int>(sizes_[dice_.rng.below(sizes_.size())]);
  const Rgb first = color(), second = color();
  switch (dice_.count(0, 5)) {
    case 0:
      return make_planks(size, first, dice_.count(2, 6), &dice_.rng);
    case 1:
      return make_tiles(size, first, second, dice_.count(2, 6), &dice_.rng);
    case 2:
      return make_checker(size, first, second, 2 * dice_.count(1, 4));
    case 3:
      return make_noise(size, first, dice_.draw(0.1f, 0.6f), dice_.count(2, 12), &dice_.rng);
    case 4:
      return make_stripes(size, first, second, dice_.count(1, 8));
    default:
      return make_picture(size, &dice_.rng);
  }
}

int Materials::surface(const std::string& name) {
  if (dice_.chance(kShares.plain)) return add(name, color());
  const int material = add(name, {1, 1, 1});
  scene::TextureRef& ref = scene_->materials.back().base_color_texture;
  ref.texture = static_cast<int>(scene_->textures.size());
  const float tile_m = dice_.log_draw(0.3f, 4);
  ref.scale = {1 / tile_m, 1 / tile_m};
  scene_->textures.push_back(pattern());
  return material;
}

int Materials::shell() { return surface("shell"); }

int Materials::thing() {
  if (things_.size() < kMaxThings && (things_.empty() || dice_.chance(0.5f))) {
    things_.push_back(surface("thing"));
    return things_.back();
  }
  return things_[dice_.rng.below(things_.size())];
}

int Materials::emitter(const std::string& name, const Rgb& radiance, bool two_sided) {
  const int material = add(name, color());
  scene_->materials.back().emission = radiance;
  scene_->materials.back().double_sided = two_sided;
  return material;
}

int Materials::screen(const Rgb& radiance, bool two_sided, float* mean) {
  const int material = emitter("screen", radiance, two_sided);
  scene::TextureRef& ref = scene_->materials.back().emission_texture;
  ref.texture = static_cast<int>(scene_->textures.size());
  const TexturePtr picture =
      dice_.chance(0.5f)
          ? make_picture(64, &dice_.rng)
          : make_checker(64, {0.9f, 0.9f, 0.9f}, {0.02f, 0.02f, 0.02f}, 2 * dice_.count(1, 6));
  double sum = 0;
  constexpr int kSteps = 16;
  for (int i = 0; i < kSteps * kSteps; ++i) {
    const int column = i % kSteps, row = i / kSteps;
    const Vec2 uv{(static_cast<float>(column) + 0.5f) / kSteps,
                  (static_cast<float>(row) + 0.5f) / kSteps};
    sum += luminance(picture->sample(uv, scene::Wrap::Repeat, scene::Wrap::Repeat, 4));
  }
  *mean = std::max(0.01f, static_cast<float>(sum / (kSteps * kSteps)));
  scene_->textures.push_back(picture);
  return material;
}

Rgb Materials::lamp_color(Dice* dice) const {
  if (muted_ || !dice->chance(kShares.colored_lamp)) return light_tint(dice->draw(0, 1));
  const Rgb color = hue_color(dice->draw(0, 1), dice->draw(0.5f, 0.95f), 1);
  return color / luminance(color);
}

}  // namespace lte::datagen::wild
