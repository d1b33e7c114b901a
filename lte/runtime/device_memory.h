// Points and answers by pointer, in memory of any device and with gaps, as other programs have
// them; and their CUDA streams. What C programs call (lte/c_api.h) is thin over this.
#pragma once

#include <cstdint>
#include <memory>

#include "lte/runtime/embedding.h"

namespace lte::runtime {

/// Triples of floats that begin `stride` bytes apart, a multiple of 4 that is at least 12.
struct TriplesIn {
  const float* data = nullptr;
  int64_t stride = 12;
};
struct TriplesOut {
  float* data = nullptr;
  int64_t stride = 12;
};

/// ScenePoints, where light and gloss that are not given are null. Pairs have no gaps.
struct ScenePointsIn {
  Device memory = {};  ///< where the arrays are
  int64_t count = 0;
  TriplesIn position = {}, normal = {}, albedo = {}, emission = {};
  const float* area = nullptr;  ///< null: all points count the same
  TriplesIn direct = {}, indirect = {}, direct_back = {}, indirect_back = {};
  const float* indirect_error = nullptr;
  const float* gloss = nullptr;
};

/// QueryPoints.
struct QueriesIn {
  Device memory = {};  ///< where the arrays are, and those of directions and answers
  int64_t count = 0;
  TriplesIn position = {}, normal = {}, albedo = {};
  /// A byte a query, `mask_stride` apart: where it is 0 nothing is read and the answer is 0. Null:
  /// all are answered.
  const uint8_t* mask = nullptr;
  int64_t mask_stride = 1;
  bool trusted = false;  ///< values are not checked
};

/// As the constructor of SceneEmbedding.
SceneEmbedding encode(const Network& network, const ScenePointsIn& points,
                      const EncodeOptions& options = {});

/// As SceneEmbedding::decode(). On a GPU it returns when the kernels are on this thread's stream.
/// @param irradiance  an entry a query, in the memory of the queries
void decode(const SceneEmbedding& embedding, const QueriesIn& queries,
            const TriplesOut& irradiance);

/// As SceneEmbedding::decode_radiance().
/// @param directions  `each` of the first query, then `each` of the second, ...
/// @param radiance    an entry a direction
void decode_radiance(const SceneEmbedding& embedding, const QueriesIn& queries,
                     const TriplesIn& directions, int64_t each, const TriplesOut& radiance);

/// While it lives, operators of this thread run on a caller's CUDA stream.
class StreamScope {
 public:
  /// @param stream  a cudaStream_t of `device`; null is its default stream
  /// @throws NoDevice in builds without CUDA, lte::Error if `device` is the CPU.
  StreamScope(Device device, void* stream);
  ~StreamScope();
  StreamScope(const StreamScope&) = delete;
  StreamScope& operator=(const StreamScope&) = delete;

 private:
  struct Guard;
  std::unique_ptr<Guard> guard_;
};

}  // namespace lte::runtime
