// The materials of one home: woods, colors and cloths that go together. Each is made when it is
// first asked for.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "datagen/common/raster.h"
#include "datagen/homes/textures/textures.h"
#include "lte/base/random.h"
#include "lte/scene/scene.h"

namespace lte::datagen::homes {

inline constexpr int kBookSpines = 24;  ///< books side by side in the texture of book_spines()

/// Materials by role. Every call returns an index into Scene::materials; albedos lie in
/// [0.03, 0.85].
class Palette {
 public:
  /// @param texture_sizes  texels an edge; one is drawn for each texture
  Palette(scene::Scene* scene, std::vector<int64_t> texture_sizes, uint64_t seed);

  int wood();        ///< the home's furniture wood, most often
  int front();       ///< doors and drawers: wood or lacquer
  int lacquer();     ///< white or colored paint
  int upholstery();  ///< of sofas and chairs
  int accent();      ///< strong cloth of cushions and throws
  int bedding();     ///< pale sheets
  int blanket();     ///< printed or woven
  int curtain();
  int metal();       ///< brushed steel, brass or black, one a home
  int chrome();      ///< pale gray of taps
  int ceramic();     ///< white
  int worktop();     ///< stone or wood
  int crockery();    ///< cups and bowls
  int glass_like();  ///< bottles: dark green, brown or blue
  int leaf();
  int pot();
  int soil();
  int bark();
  int paper();
  int books();   ///< kBookSpines columns; see book_spines()
  int screen();  ///< dark
  int black();   ///< dark plastic
  int mirror();  ///< pale plain
  int trim();    ///< skirting, frames
  int ceiling();
  int wall_paint();  ///< paint, plaster or paper, new at every call
  int wall_tiles();
  int floor_wood();  ///< the same through the home
  int floor_tiles();
  int rug();      ///< UV [0, 1]²; new at every call
  int picture();  ///< UV [0, 1]²; new at every call
  /// An emitter of one side, new at every call.
  int emitter(const std::string& name, const Rgb& radiance, float albedo = 0.7f);

 private:
  int add(const std::string& name, const Rgb& color);
  int add(const std::string& name, const TexturePtr& texture, Vec2 tile_m);
  int size() { return static_cast<int>(sizes_[rng_.below(sizes_.size())]); }
  float draw(float low, float high) { return rng_.uniform(low, high); }
  int count(int low, int high) {
    return low + static_cast<int>(rng_.below(static_cast<uint64_t>(int64_t{high} - low + 1)));
  }
  bool chance(float probability) { return rng_.uniform() < probability; }
  Rgb scheme_color(float saturation, float low, float high);
  int cloth(const std::string& name, const Rgb& first, const Rgb& second, bool printed);
  /// Returns one of at most `limit` materials of this role, made by `make` when it is first drawn.
  template <typename Make>
  int shared(const std::string& role, size_t limit, const Make& make);

  scene::Scene* scene_;
  std::vector<int64_t> sizes_;
  Rng rng_;
  std::map<std::string, std::vector<int>> roles_;
  float hue_, wood_hue_, wood_tone_, wood_saturation_;
};

}  // namespace lte::datagen::homes
