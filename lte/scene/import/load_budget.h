// What one import has taken of what its limits allow.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lte/scene/import/limits.h"

namespace lte::scene {

/// A picture as its header has it.
struct DeclaredPicture {
  std::string where;  ///< file and element, for messages
  int64_t width = 0, height = 0;
};

/// Bytes that a scene keeps for a pixel of a texture: 3 of color, and 2 for the mip levels, which
/// have a third of the pixels in 6 bytes each.
inline constexpr int64_t kTextureBytes = 5;
/// The same of an environment's picture, which is three floats.
inline constexpr int64_t kEnvironmentBytes = 12;

class LoadBudget {
 public:
  explicit LoadBudget(const LoadLimits& limits) : limits_(limits) {}

  const LoadLimits& limits() const { return limits_; }

  /// Counts pictures that are about to be decoded.
  /// @throws OverLimit for the first that has too many pixels, and for the first that is too much
  /// with those before; the value needed is that of them all.
  void add_pictures(const std::vector<DeclaredPicture>& pictures, int64_t bytes_per_pixel);

  /// What compressed data may still unfold into.
  int64_t inflated_left() const { return limits_.inflated_bytes - inflated_; }
  /// Counts what compressed data unfold into.
  /// @throws OverLimit beyond LoadLimits::inflated_bytes.
  void add_inflated(int64_t bytes, const std::string& where);

 private:
  LoadLimits limits_;
  int64_t picture_bytes_ = 0, inflated_ = 0;
};

/// "1.28 GB", "640 bytes".
std::string size_text(int64_t bytes);

}  // namespace lte::scene
