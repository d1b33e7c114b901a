// Holds answered light to account by a few thousand paths: how far it is off, as a whole and by
// region of the scene, and whether that is more than noise.
//
// All figures are ratios of sums over places, which count evenly: answers over traced light. Their
// standard errors are those of the delta method over kCheckBatches independent batches, each of
// paths and (where there are many) of places of its own. Regions are the cells of a k-d tree over
// the places, cut in two as long as both halves know their ratio well enough.
//
// Paths have heavy tails: light that comes by rare bright paths is missed together with the spread
// that would have shown it. And the more regions there are, the more of them look wrong by chance.
// So what the first paths suspect, others must confirm: fresh paths from fresh places of the
// suspected regions alone, tested anew at three standard errors, corrected for their number.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "lte/base/math.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/lights/lights.h"

namespace lte::infer {

/// What was answered at places of a scene, an entry each: at pixels of a picture or at points.
struct AnsweredLight {
  std::vector<Vec3> position, normal;  ///< world space; unit normals, on the side that was asked
  std::vector<Rgb> irradiance;         ///< indirect, W/m²

  size_t size() const { return position.size(); }
  void add(const Vec3& at, const Vec3& side, const Rgb& light);
};

/// Light may be off by so much, as a whole and in a region, before anything is said.
inline constexpr double kCheckedOff = 0.05, kCheckedRegionOff = 0.1;
inline constexpr int kCheckBatches = 32;

/// The fewest paths of a check, and the most; as many again confirm a suspicion.
inline constexpr int64_t kMinCheckPaths = 1 << 13, kMaxCheckPaths = 1 << 16;

struct CheckOptions {
  int64_t max_paths = kMaxCheckPaths;
  /// For who keeps to a time: the check ends when its next paths would not be done in so many
  /// seconds, after the first kMinCheckPaths. By default counts alone decide, and the outcome is
  /// the same every time.
  double seconds = std::numeric_limits<double>::infinity();
  int max_depth = 5;  ///< of the paths: surface hits after the place
  uint64_t seed = 0;
};

/// Paths that take about a tenth of the time of so many gathered rays, within what a check may
/// have.
int64_t paths_to_check(int64_t rays);

/// The ratio of answered to traced light over some of the places.
struct CheckedRatio {
  double ratio = 1, standard_error = 0;
  double share = 1;  ///< of all places
  Vec3 centre;       ///< the place nearest to the mean of these places
  bool off = false;  ///< confirmed: wrong by more than is let pass, and not by chance
  /// What the light here is expected to be off by, squared and relative to it: the ratio as it is
  /// where that is confirmed, else gi::shifted_square().
  double expected_square = 0;
};

struct LightCheck {
  CheckedRatio whole;
  std::vector<CheckedRatio> regions;  ///< disjoint; at least one where anything was compared
  std::vector<int32_t> region_of;     ///< of each place: a number of `regions`
  /// Of all regions that are off to the same side, the side that is off by more light; `centre` is
  /// that of the one which is off by the most. Nothing if that is little for so few places.
  std::optional<CheckedRatio> fault;
  int64_t paths = 0;
  double seconds = 0;

  bool off() const { return whole.off || fault.has_value(); }
};

/// @param answered  may be empty: then nothing is compared
/// @throws lte::Error if sizes differ or a value is not finite.
LightCheck check_light(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                       const AnsweredLight& answered, const CheckOptions& options);

}  // namespace lte::infer
