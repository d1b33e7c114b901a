// What a gathered picture spends where it has to be ready in time: rays block by block, and then
// paths through its pixels, pass by pass, until the time is used.
//
// Costs are those that this picture has shown so far. A pass takes half of the time that is left at
// most, so that a machine that becomes twice as slow in it is still in time.
#pragma once

#include <cstdint>
#include <functional>

#include "infer/renderer/point_light.h"

namespace lte::infer {

/// What the plan expects of a picture; seconds by the pace's clock.
struct PaceSettings {
  double budget_s = 0;  ///< of the whole picture
  /// Of a picture's pixel: what gathered light and all that shows it may take before paths; and of
  /// that, what is expected to come after the rays.
  double base_s = 0, after_rays_s = 0;
  double gather_s = 0, shadow_s = 0;  ///< a ray
  double path_s = 0;                  ///< a path through a pixel
  double finish_s = 0;                ///< a pixel whose correction is smoothed
  bool paths = true;                  ///< time beyond the base is for them
  int rough_first = 0;                ///< paths of rough pixels in either half before smooth ones'
  double least = 1, most = 1;         ///< rays, in multiples of the wanted ones
};

/// Paths of the next pass in both halves, a pixel.
struct PixelPass {
  int rough = 0, smooth = 0;
  bool empty() const { return rough == 0 && smooth == 0; }
};

class PicturePace {
 public:
  /// What correcting rough pixels alone takes of the time that all take: one of two drawings.
  static constexpr double kRoughFinish = 0.29;

  /// @param clock  seconds since the work has begun
  PicturePace(const PaceSettings& settings, std::function<double()> clock);

  /// Rows of the picture begin; they have a share of the time that is left.
  /// @param pixels  of these rows @param after  of the rows below them
  void begin_rows(int64_t pixels, int64_t after);

  /// Rays for the next points of these rows, where `left` are still without light.
  LightRays rays(const LightRays& wanted, int64_t left) const;
  /// Rays were cast, which took this work.
  void add_rays(const LightRays& rays, const LightWork& work);

  /// The gathered rows are there. @param rough, smooth  pixels of either kind
  void begin_paths(int64_t rough, int64_t smooth);
  /// The next pass; empty where no time is left for one. First for those of rough pixels alone,
  /// which have most to gain, then for five there and one in each smooth pixel.
  PixelPass next_pass();
  /// It is done.
  void add_pass(const PixelPass& pass);

  /// Rays a point so far, on average; 0 if none.
  double mean_gather_rays() const { return mean(gathered_); }
  double mean_shadow_rays() const { return mean(shadowed_); }

 private:
  double mean(int64_t rays) const {
    return work_.points > 0 ? static_cast<double>(rays) / static_cast<double>(work_.points) : 0;
  }
  double pass_paths(const PixelPass& pass) const;
  bool fits(const PixelPass& pass, double share) const;

  const PaceSettings settings_;
  std::function<double()> clock_;
  double gather_rate_, shadow_rate_, path_rate_;
  int64_t pixels_ = 0;                      ///< of these rows
  double rows_end_s_ = 0, base_end_s_ = 0;  ///< on the clock
  LightWork work_;                          ///< so far
  int64_t gathered_ = 0, shadowed_ = 0;     ///< rays of it
  int64_t rough_ = 0, smooth_ = 0;
  PixelPass paths_;  ///< in these rows so far
  double pass_begin_s_ = 0;
};

}  // namespace lte::infer
