// View consistency: how much the light of the same surface points changes while the camera moves
// and the scene does not. The network's answers at points must not change at all; pictures change
// by what stands between answers and pixels, and path tracing by its noise.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "infer/picture/flicker.h"
#include "infer/renderer/renderer.h"

namespace lte::experiments {

struct ConsistencyOptions {
  int width = 160, height = 120;
  int frames = 60;
  int spp = 16;         ///< paths a pixel of what the network is set beside
  int max_depth = 5;    ///< of those
  double degrees = 60;  ///< that the camera turns from the first frame to the last
  uint64_t seed = 0;    ///< of the first frame; each has the next, as noise is drawn anew
};

/// Answers at points that are asked again and again: how far they move from the first ones.
class RepeatedAnswers {
 public:
  explicit RepeatedAnswers(size_t points) : first_(points), known_(points, 0) {}
  /// @param points   numbers of those that are answered
  /// @param answers  an entry each
  void add(std::span<const size_t> points, std::span<const Rgb> answers);

  int64_t compared() const { return compared_; }      ///< answers with one before them
  double largest_change() const { return largest_; }  ///< W/m², of any channel

 private:
  std::vector<Rgb> first_;
  std::vector<uint8_t> known_;
  int64_t compared_ = 0;
  double largest_ = 0;
};

/// A way to make the frames, and how much its light changes between them.
struct ConsistencyRow {
  std::string name;
  infer::Flicker indirect, total;  ///< of indirect irradiance alone, and with direct
};

struct Consistency {
  int64_t points = 0;         ///< of surfaces, asked in every frame that sees them
  int64_t answers = 0;        ///< that were compared with the first at their point
  double largest_change = 0;  ///< between those, W/m²
  std::string denoiser;
  std::vector<ConsistencyRow> rows;
};

/// A camera that turns in its place, or around what it looks at, in even steps.
std::vector<scene::Camera> consistency_cameras(const pathtrace::Bvh& bvh,
                                               const scene::Camera& first,
                                               const ConsistencyOptions& options);

/// @param renderer  with an embedding
/// @param cameras   two or more
Consistency measure_consistency(infer::Renderer* renderer, std::span<const scene::Camera> cameras,
                                const ConsistencyOptions& options);

}  // namespace lte::experiments
