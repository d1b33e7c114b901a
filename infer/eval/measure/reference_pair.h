// What pictures are compared with: two independent path-traced pictures A and B of a view, kept in
// a folder from one run to the next. The mean of (x - A)(x - B) is the squared error of a picture x
// without their noise, and half the mean of (A - B)^2 is the variance of either.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "infer/renderer/renderer.h"
#include "lte/image/image.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// One of both; [height, width, 3].
struct ReferencePicture {
  image::Image whole;       ///< radiance towards the camera, paths spread over each pixel
  image::Image indirect;    ///< of that, what was reflected more than once
  image::Image irradiance;  ///< indirect irradiance at pixel centres, W/m²; empty unless wanted
};
using ReferencePair = std::array<ReferencePicture, 2>;

struct PairSettings {
  int width = 0, height = 0;
  int paths = 128;    ///< a pixel, of each picture
  int max_depth = 5;  ///< surface hits after the primary one
  uint64_t seed = 0;  ///< hashed, so that no method of the same seed shares paths with the pair
  bool irradiance = false;
  std::filesystem::path folder;  ///< where pairs are kept; empty: nowhere
  bool progress = true;          ///< show it while paths are traced
  /// Given numbers of traced pixels by the threads that traced them, pair_pixels() in all. May be
  /// null.
  std::function<void(int64_t pixels)> done;

  int64_t pair_pixels() const { return int64_t{width} * height * (irradiance ? 4 : 2); }
};

/// A kept reference that is damaged or was made by another version.
class ReferenceFault : public Error {
 public:
  using Error::Error;
};

/// Reads the pair of a view, or traces and keeps it. Its file is named by `name`, size, paths of
/// both, depth and a checksum of scene (scene/fingerprint.h), camera and seed. The header has the
/// version and two checksums: of the file's own pictures, and of the same view with one path a
/// pixel, in which a change of the path tracer shows. Its layers are the means of both pictures
/// and, as "half", "indirect_half" and "irradiance_half", half of their differences.
/// @throws ReferenceFault naming the file
ReferencePair find_reference_pair(Renderer* renderer, const scene::Camera& camera,
                                  const std::string& name, const PairSettings& settings);

/// The mean of two pictures of one size.
image::Image mean_of_pair(const image::Image& a, const image::Image& b);

/// Checksum of all that decides what the pair is: scene, camera, settings and path tracer. For
/// what is derived from it. 16 hexadecimal digits.
std::string pair_fingerprint(const Renderer& renderer, const scene::Camera& camera,
                             const PairSettings& settings);

/// Looks at the headers of all kept pairs of a folder, if there is one.
/// @throws ReferenceFault naming the first file that this version cannot use
void check_kept_pairs(const std::filesystem::path& folder);

/// The text with everything but ASCII letters and digits as '_', for names of files.
std::string file_words(const std::string& text);

}  // namespace lte::infer
