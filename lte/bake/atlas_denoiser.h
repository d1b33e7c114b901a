// Noise taken out of the light of texels by Open Image Denoise, in the picture of their atlas.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lte/bake/texels.h"
#include "lte/image/oidn.h"

namespace lte::bake {

/// Borrows atlas and texels.
///
/// It knows nothing of the world: charts that lie side by side are one picture to it, and what that
/// costs is for bake::smooth() to find. Dark texels are black there, which keeps what lies beyond
/// them apart; filled like the space between charts they made a tenth more error.
class AtlasDenoiser {
 public:
  /// @param dark  [texels] not 0: has no light
  /// @return      nothing where the library is not found
  static std::optional<AtlasDenoiser> find(const Atlas& atlas, const Texels& texels,
                                           std::span<const uint8_t> dark);

  /// "Open Image Denoise 2.5.1".
  const std::string& name() const { return oidn_.name(); }
  /// @param light  [texels] W/m², finite and not negative
  /// @return       the same size
  std::vector<Rgb> operator()(const std::vector<Rgb>& light) const;

 private:
  AtlasDenoiser(const Atlas& atlas, const Texels& texels, std::span<const uint8_t> dark,
                image::Oidn oidn);

  const Atlas& atlas_;
  const Texels& texels_;
  std::vector<uint8_t> mask_;  ///< [pixels] of Texel
  image::Oidn oidn_;
};

}  // namespace lte::bake
