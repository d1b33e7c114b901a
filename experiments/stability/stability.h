// lte_bench stability: whether answers stay finite, and how much they change, where a scene
// changes and its light does not: more triangles, other units, coincident surfaces, a lamp in
// pieces, other arithmetic, other threads, another order.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lte/base/math.h"
#include "lte/runtime/device.h"

namespace lte::experiments {

struct StabilityOptions {
  bool quick = false;              ///< small sizes, for a few seconds
  int64_t triangles = 10'000'000;  ///< of the largest scene
  std::string checkpoint;          ///< empty: the shipped model
  runtime::Device device;          ///< of the network
};

/// What a figure of a change may be held to.
enum class Figure { None, Shift, Mean, Max };

struct Bound {
  Figure of = Figure::None;
  double most = 0;
};

/// How answers differ from those of a base case, over the mean of its absolute values.
struct Change {
  int64_t values = 0, non_finite = 0;  ///< those that are not finite enter no other figure
  double shift = 0;                    ///< of the mean of all values: blind to noise
  double mean = 0, p99 = 0, most = 0;  ///< of the absolute differences

  double of(Figure figure) const;
  bool keeps(const Bound& bound) const { return non_finite == 0 && of(bound.of) <= bound.most; }
};

/// @param factor  what the answers are divided by first
Change compare(std::span<const Rgb> answers, std::span<const Rgb> base, double factor = 1);

struct StabilityRow {
  std::string group;    ///< subject: "triangles"
  std::string name;     ///< of the case: "10,000,000"
  std::string what;     ///< paths, or network
  std::string against;  ///< the base case
  Change change;
  Bound bound;
  double seconds = 0;            ///< wall-clock, of `what` alone
  double processor_seconds = 0;  ///< user and system
  double bvh_seconds = 0;        ///< of the scene's BVH and lights, wall-clock
  int64_t triangles = 0;

  bool holds() const { return change.keeps(bound); }
};

std::vector<StabilityRow> measure_stability(const StabilityOptions& options);

}  // namespace lte::experiments
