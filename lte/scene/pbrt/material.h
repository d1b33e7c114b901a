// PBRT's materials as albedo and metal.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lte/scene/pbrt/texture.h"
#include "lte/scene/pbrt/world.h"
#include "lte/scene/surface.h"

namespace lte::scene::pbrt {

class MaterialTable {
 public:
  MaterialTable(const World& world, const TextureTable& textures, const Files& files,
                IgnoredFeatures* ignored)
      : world_(world), textures_(textures), files_(files), ignored_(ignored) {}

  /// The albedo of World::materials[index]; nullptr for pbrt's "interface", which is not seen.
  /// @throws lte::Error with file and line for a material that is named but never made, or a
  /// mixture of itself.
  TexturePtr albedo(int index) { return follow(index, 0).albedo; }
  /// How much of the material is metal, and how rough that is.
  Gloss gloss(int index) { return follow(index, 0).gloss; }

 private:
  struct Built {
    TexturePtr albedo;  ///< of a metal: reflectance at normal incidence
    Gloss gloss;
  };
  Built follow(int index, int depth);
  Built build(const MaterialDef& def, int depth);
  Built mixture(const MaterialDef& def, int depth);
  Built metal(const MaterialDef& def);
  TexturePtr conductor(const Params& params, const std::string& prefix);
  float roughness(const MaterialDef& def, const std::string& prefix);

  const World& world_;
  const TextureTable& textures_;
  const Files& files_;
  IgnoredFeatures* ignored_;
  std::map<int, Built> built_;
};

}  // namespace lte::scene::pbrt
