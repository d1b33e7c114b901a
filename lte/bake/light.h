// Light at texels: which side of each chart it reaches, where it reaches at all, and how much.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lte/bake/estimate.h"
#include "lte/bake/texels.h"
#include "lte/render/integrator.h"

namespace lte::bake {

/// Sums over passes, which alternate between two halves. `direct` is empty where it is not wanted.
struct TexelSamples {
  std::array<std::vector<Rgb>, 2> direct, indirect;  ///< [texels] W/m²
  std::array<int, 2> passes{};                       ///< of texels with the full rate

  TexelSamples() = default;
  TexelSamples(size_t texels, bool with_direct);
  /// Of `direct` or `indirect`. @param rate  LightState::rate
  Halves means(const std::array<std::vector<Rgb>, 2>& sums, std::span<const uint8_t> rate) const;
  /// All light of a texel that the samples have found.
  Rgb sum(size_t texel) const;
};

/// Lit texels that belong to a shard together.
inline constexpr size_t kShardBlock = 4096;

/// A part of a bake, for processes that share one: every so many blocks of the lit texels.
struct Shard {
  int number = 0, count = 1;

  /// @param place  of a texel among the lit ones
  bool has(size_t place) const {
    return static_cast<int>(place / kShardBlock % static_cast<size_t>(count)) == number;
  }
};

/// What the passes so far have found, from which a bake goes on as if it had not stopped.
struct LightState {
  std::vector<uint8_t> dark, back;  ///< TexelLight has these
  std::vector<uint8_t> rate;        ///< [texels] sampling_rates(), of passes after the first two
  int64_t two_sided = 0;
  TexelSamples samples, paths;
  /// Neighbours on these sides, of texels that are not dark. Null where the state was read.
  std::shared_ptr<const TexelGraph> graph;
};

/// Which side of each chart is baked.
struct Sides {
  std::vector<uint8_t> back;  ///< [charts] 1: light of the back
  int64_t two_sided = 0;      ///< texels lit on both sides, of which the brighter was taken
};

/// Rays of a texel in a pass of paths that correct what was gathered.
inline constexpr int kPathsAPass = 2;

/// What samples are drawn. Passes alternate between two halves.
struct LightOptions {
  bool direct = false;  ///< beside indirect light
  int passes = 8;       ///< by the integrator, mean over texels; at least 2
  /// A texel and pass, each at a place of its own in the texel; as many light samples beside them.
  int rays = 3;
  int path_passes = 0;  ///< of two paths a texel, which correct what was gathered; mean, even
  int max_depth = 5;
  double seconds = INFINITY;  ///< passes after the first two end by then, and so does what follows
  double error = 0;           ///< passes end at this relative_error() of indirect light; 0: none
  uint64_t seed = 0;
  const Sides* sides = nullptr;  ///< those to bake, as of all light; null: those that light reaches
  std::function<void(double share)> progress;  ///< of the work, (0, 1], ascending; may be empty
  /// All texels have the first two passes, which tell sides and darkness; later ones are the
  /// shard's. With `seconds` or `error` there is one.
  Shard shard = {};
  const LightState* from = nullptr;  ///< where to go on, made by the same options; may be null
  /// Told where the bake stands, whenever both halves have got a pass. May be empty.
  std::function<void(const LightState&)> keep = {};
};

/// Records of the irradiance cache. Texels see into narrower gaps than pixels do, so there are
/// more; and more yet where many rays read them, once the noise of each is small.
/// @param texels  of the light map, about
int64_t record_count(double texels, const LightOptions& options);

/// Paths of each of so many records: all of them take a small part of the time of the rays that
/// read them. Their noise is shared by those rays.
int record_paths(double texels, int64_t records, const LightOptions& options);

struct TexelLight {
  std::vector<Rgb> irradiance;  ///< [texels] W/m², 0 where dark
  std::vector<uint8_t> dark;    ///< [texels] 1 where no light reaches
  std::vector<uint8_t> back;    ///< [charts] 1: light of the back
  int64_t two_sided = 0;        ///< texels lit on both sides, of which the brighter was taken
  double expected_error = 0;    ///< Provenance::expected_error
  double passes = 0;            ///< by the integrator, mean over lit texels
  double paths = 0;             ///< a texel, traced to its end; mean
  std::string denoiser;         ///< Provenance::denoiser
};

/// The sides that light reaches, without a bake. The integrator has been prepared.
Sides find_sides(const render::Integrator& integrator, const Atlas& atlas, const Texels& texels,
                 const LightOptions& options);

/// All passes of a shard. The integrator has been prepared.
/// @throws lte::Error if an option is out of range
LightState sample_texels(const render::TracedScene& scene, const render::Integrator& integrator,
                         const Atlas& atlas, const Texels& texels, const LightOptions& options);

/// The samples of one state: those of all shards, in their order.
/// @throws lte::Error where they are not of one bake
LightState joined(const std::vector<LightState>& shards);

/// The light of texels by samples of all of them.
/// @param method  of the integrator
TexelLight light_of(const pathtrace::Bvh& bvh, render::Method method, const Atlas& atlas,
                    const Texels& texels, const LightOptions& options, LightState state);

/// Light at texels of an atlas of the scene: the two above. The integrator has been prepared.
/// @throws lte::Error if an option is out of range
TexelLight light_texels(const render::TracedScene& scene, const render::Integrator& integrator,
                        const Atlas& atlas, const Texels& texels, const LightOptions& options);

/// Indirect light of some texels by plain paths at places all over them, without smoothing: what a
/// bake is measured against. Texels of `which` ascend.
/// @param back  TexelLight::back
/// @return  [which] W/m²
std::vector<Rgb> trace_texels(const render::TracedScene& scene, const Atlas& atlas,
                              const Texels& texels, const std::vector<uint8_t>& back,
                              std::span<const uint32_t> which, const LightOptions& options);

/// Normals of the sides that were baked.
std::vector<Vec3> turned_normals(const Texels& texels, const std::vector<uint8_t>& back);

}  // namespace lte::bake
