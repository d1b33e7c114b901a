// Light of a scene that was baked before and has changed since: texels whose light is another one
// are sampled anew, the others keep what they have.
#pragma once

#include <cstdint>
#include <vector>

#include "lte/bake/light.h"
#include "lte/bake/relayout.h"

namespace lte::bake {

/// What an earlier bake of one layer has left. Texels are those of its own atlas.
struct OldLight {
  LightState state;
  std::vector<int32_t> pixel, instance,
      chart;                   ///< [texels] as Texels has them
  std::vector<float> picture;  ///< [height, width, 3] W/m²
  std::vector<uint8_t> mask;   ///< [height, width] of Texel
};

/// A texel that has no old one.
inline constexpr int32_t kNew = -1;

struct RebakeOptions {
  /// Of the light at a texel: where the change, or the doubt about it, is more, it is baked anew.
  double tolerance = 0.02;
};

/// What of an old bake stays.
struct Kept {
  std::vector<int32_t> old_texel;  ///< [texels] number in OldLight; kNew where an object moved
  std::vector<uint8_t> changed;    ///< [texels] 1: baked anew
  std::vector<uint8_t> near;       ///< [texels] 1: takes part in smoothing what is
};

/// Finds the texels whose light has changed: paths of the same random numbers in both scenes differ
/// where they meet what is not the same.
/// @param before  the scene of the old bake, `now` the scene as it is
Kept find_changes(const render::TracedScene& before, const render::TracedScene& now,
                  const Relayout& relayout, const OldLight& old, const LightOptions& options,
                  const RebakeOptions& rebake);

/// Samples of all texels: new ones where light has changed. The integrator has been prepared.
LightState rebake(const render::TracedScene& scene, const render::Integrator& integrator,
                  const Layout& layout, const LightOptions& options, const OldLight& old,
                  const Kept& kept);

/// The light of those samples; what has not changed is as the old picture has it.
TexelLight rebaked_light(const pathtrace::Bvh& bvh, render::Method method, const Layout& layout,
                         const LightOptions& options, LightState state, const OldLight& old,
                         const Kept& kept);

/// Puts the old pixels back wherever nothing near them has been baked anew, bit for bit.
void restore_kept(const Layout& layout, const OldLight& old, const Kept& kept, Lightmap* map);

}  // namespace lte::bake
