#include "datagen/common/metals.h"

#include <cmath>
#include <vector>

#include "datagen/common/textures.h"
#include "lte/base/random.h"

namespace lte::datagen {
namespace {

constexpr uint64_t kMetalStream = 0x6d65746c;

void make_metal(const Range& roughness, Rng* rng, scene::Material* material) {
  // From the warm tint of gold or copper to the gray of steel and aluminium.
  const float hue = rng->uniform(0.03f, 0.14f), saturation = rng->uniform(0, 0.6f);
  const Rgb color = make_color(hue, saturation, rng->uniform(0.5f, 0.9f));
  const double turn = rng->uniform();
  if (material->base_color_texture.texture == scene::kNone) material->base_color = color;
  material->metallic = 1;
  material->roughness =
      static_cast<float>(roughness.low * std::pow(roughness.high / roughness.low, turn));
}

}  // namespace

void add_metals(const MetalConfig& config, uint64_t seed, scene::Scene* scene) {
  if (config.share <= 0) return;
  Rng rng(seed, kMetalStream);
  std::vector<scene::Material*> candidates, chosen;
  for (scene::Material& material : scene->materials) {
    if (!material.emissive()) candidates.push_back(&material);
  }
  if (candidates.empty()) return;
  for (scene::Material* material : candidates) {
    if (rng.uniform() < config.share) chosen.push_back(material);
  }
  if (chosen.empty()) chosen.push_back(candidates[rng.below(candidates.size())]);
  for (scene::Material* material : chosen) make_metal(config.roughness, &rng, material);
}

}  // namespace lte::datagen
