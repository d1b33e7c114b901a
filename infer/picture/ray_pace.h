// How many shadow rays a pixel gets where a picture has to be ready in time.
#pragma once

#include <cstdint>
#include <functional>

namespace lte::infer {

/// Hands out rays block by block, so that the last block ends in time. Rates are those measured so
/// far in the same picture.
class RayPace {
 public:
  /// @param budget_s       of the whole picture, on `clock`
  /// @param second_a_ray   of a shadow ray at a query, as measured before the picture; 0 if unknown
  /// @param most           rays a pixel at most
  /// @param clock          seconds since the picture began
  RayPace(double budget_s, double second_a_ray, int most, std::function<double()> clock);

  /// Rows of the picture begin whose first hits are to be found.
  /// @param pixels  of these rows @param after  of the rows below them
  void begin_rows(int64_t pixels, int64_t after);
  /// Rays for the next block, where `left` queries of these rows are still without direct light.
  /// 1 at least. Numbers that the path tracer would round up are not given.
  int rays(int64_t left);
  /// A block is done.
  void add(int64_t queries, int rays, double seconds);
  /// Whether what is left suffices for one ray a query and no more.
  bool late() const;

  double seconds_left() const { return budget_s_ - clock_(); }
  /// Rays a query so far; 0 if none.
  double mean_rays() const;

 private:
  double reserve(int64_t pixels) const;
  double second_a_ray() const;

  double budget_s_, rate_;
  int most_;
  std::function<double()> clock_;
  int64_t begun_ = 0, rows_ = 0, after_ = 0;  ///< pixels: in all so far, of these rows, below
  int64_t queries_ = 0, cast_ = 0;            ///< done; their rays
  double start_s_ = -1, direct_s_ = 0;
};

/// The greatest number of rays up to `rays` that pathtrace::estimate_irradiance() takes as it is.
int whole_rays(double rays);

}  // namespace lte::infer
