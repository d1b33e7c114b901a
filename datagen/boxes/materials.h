// The materials of a room of boxes, drawn at random within realistic ranges of albedo.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datagen/common/textures.h"
#include "lte/base/random.h"
#include "lte/scene/scene.h"

namespace lte::datagen::boxes {

/// Appends materials and textures to a scene and returns the material's index. Wood, paint and
/// fabric come from small palettes, so that the furniture of a room goes together and textures are
/// shared.
class MaterialFactory {
 public:
  /// @param texture_sizes  texels an edge; one is drawn for each texture
  MaterialFactory(scene::Scene* scene, std::vector<int64_t> texture_sizes, uint64_t seed);

  int floor();    ///< planks, tiles, checker, carpet or plain; luminance 0.1 to 0.6
  int wall();     ///< light paint 0.4 to 0.85; sometimes papered or strongly colored
  int ceiling();  ///< near white, 0.6 to 0.85
  int wood();
  int paint();  ///< furniture lacquer, any color
  int fabric();
  int trim();  ///< white paint of frames and door jambs
  int dark();  ///< screens, lamp poles
  /// A painting that covers a face of the given size once.
  int picture(float width_m, float height_m);
  /// An emitter of one side.
  int light(const Rgb& radiance);

 private:
  int add(const std::string& name, const Rgb& color);
  /// @param tile_m  metres that the texture spans
  int add(const std::string& name, const TexturePtr& texture, Vec2 tile_m);
  int texture_size();
  Rgb color(float saturation_high, float low, float high);
  /// A member of `palette`, which grows by `make` up to `limit` members.
  template <typename Make>
  int from_palette(std::vector<int>* palette, size_t limit, const Make& make);

  scene::Scene* scene_;
  std::vector<int64_t> texture_sizes_;
  Rng rng_;
  std::vector<int> woods_, paints_, fabrics_;
  int trim_ = scene::kNone, dark_ = scene::kNone;
};

}  // namespace lte::datagen::boxes
