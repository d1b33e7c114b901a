// The light transport embedding of one scene, and irradiance at any surface point from it.
//
// The embedding is made once; every camera and every set of query points reads it. Neither Embree
// nor a scene file is needed.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lte/base/math.h"
#include "lte/runtime/memory_limit.h"
#include "lte/runtime/network.h"
#include "lte/runtime/points.h"

namespace lte::runtime {

struct EncodeOptions {
  /// Shrinks a scene that is wider than the model's scale, and enlarges one that is narrower than
  /// Network::least_extent(), for the network only. That is exact for light that comes from
  /// surfaces: uniform scaling of a scene does not change its irradiance.
  bool rescale = false;
  /// The least corner of the scene, no more than any position; by default that of the points. Give
  /// it so that an edit of the scene moves no point in network space.
  std::optional<Vec3> origin = {};
  /// Encoding refuses what would not fit, and decoding takes no more queries at a time than do.
  MemoryLimit memory = {};
  /// Keeps what the encoder's blocks attend to, for SceneAttention (attention.h). The embedding is
  /// the same to the last bit; making it takes longer, and it holds more memory.
  bool record_attention = false;
};

struct EmbeddingInfo {
  int64_t scene_points = 0;             ///< M that were encoded
  int64_t latents = 0;                  ///< m, about M / 4
  int64_t bytes = 0;                    ///< of memory that the embedding holds
  std::array<double, 3> origin = {};    ///< least corner, world
  double scale = 0;                     ///< metres that the network takes for its unit
  std::array<double, 3> emission = {};  ///< mean by channel under the gain of now
};

/// Any number of threads may use one at the same time.
class SceneEmbedding {
 public:
  /// Runs the encoder. The order of the points counts for nothing (nn::in_canonical_order()).
  /// @throws lte::Error of one line for arrays of different lengths, values that are not finite or
  ///         light that the network reads and that is missing; SceneTooLarge; NotEnoughMemory.
  SceneEmbedding(const Network& network, const ScenePoints& points,
                 const EncodeOptions& options = {});
  SceneEmbedding(SceneEmbedding&&) noexcept;
  SceneEmbedding& operator=(SceneEmbedding&&) noexcept;
  ~SceneEmbedding();

  const Network& network() const;
  EmbeddingInfo info() const;
  /// Mean emission over points and channels under the gain of now, 1 without emission.
  double mean_emission() const;

  /// Dims or tints all light of the scene: exact, as light is linear, and free. Calls of decode()
  /// that have begun keep the gain before.
  /// @param gain  over the emission that was encoded
  void set_emission_gain(const std::array<double, 3>& gain);

  /// Irradiance in W/m², one entry a query. Memory beyond the result does not grow with their
  /// number.
  /// @throws lte::Error of one line for arrays of different lengths and values that are not finite;
  ///         NotEnoughMemory.
  std::vector<Rgb> decode(const QueryPoints& queries) const;

  /// Irradiance in W/m² that the network's answer is a factor on: the light on the scene points,
  /// path-traced estimates or a radiosity solution, interpolated (nn::LightPrior). Empty for a
  /// network without such a cache.
  /// @throws lte::Error as decode()
  std::vector<Rgb> light_prior(const QueryPoints& queries) const;

  /// Incident radiance in W sr^-1 m^-2 from so many directions of each query: of the light that the
  /// model answers for, as irradiance is. Those of one query share what is gathered around it.
  /// @param directions  the first query's, then the second's, ...: world, unit, away from the
  ///                    surface
  /// @return  one entry a direction
  /// @throws lte::Error of one line as decode(), for a model without a radiance decoder, for
  ///         directions that are not as many for each query, not unit or point into the surface.
  std::vector<Rgb> decode_radiance(const QueryPoints& queries,
                                   std::span<const Vec3> directions) const;

 private:
  friend struct TorchParts;
  struct State;
  explicit SceneEmbedding(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace lte::runtime
