// Materials of a wild scene: albedos from 0.02 to 0.97, plain, saturated or textured.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datagen/common/raster.h"
#include "datagen/wild/dice.h"
#include "lte/scene/scene.h"

namespace lte::datagen::wild {

class Materials {
 public:
  /// @param texture_sizes  texels an edge; one is drawn for each texture
  Materials(scene::Scene* scene, std::vector<int64_t> texture_sizes, uint64_t seed);

  int shell();  ///< new at every call
  int thing();  ///< of furniture: one of at most eight
  /// White from cool to warm, or, now and then, saturated; of luminance 1.
  Rgb lamp_color(Dice* dice) const;
  /// Of the given radiance; albedo as any other surface.
  int emitter(const std::string& name, const Rgb& radiance, bool two_sided);
  /// Whose radiance is the texture times `radiance`; UVs in [0, 1]².
  int screen(const Rgb& radiance, bool two_sided, float* mean);

 private:
  int add(const std::string& name, const Rgb& color);
  int surface(const std::string& name);
  Rgb color();
  TexturePtr pattern();

  scene::Scene* scene_;
  std::vector<int64_t> sizes_;
  Dice dice_;
  int key_;
  bool muted_;
  std::vector<int> things_;
};

}  // namespace lte::datagen::wild
