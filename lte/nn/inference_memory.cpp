#include "lte/nn/inference_memory.h"

#include <algorithm>

namespace lte::nn {
namespace {

constexpr double kMiB = 1 << 20;

double real(int64_t value) { return static_cast<double>(value); }

}  // namespace

double encode_mb(const ModelConfig& config, int64_t M) {
  const double D = real(config.channels);
  const double light = config.reads_light() ? 300 : 0;        // bytes of that of both sides
  const double discs = config.predicts_radiance() ? 500 : 0;  // bytes of what rays meet
  const double per_point = 600 + light + discs + 40 * D;
  const double base = 20 + 0.45 * D;  // MiB, whatever the number of points
  return base + 1.1 * per_point * real(M) / kMiB;
}

double decode_mb(const ModelConfig& config, int64_t Q, int64_t block) {
  constexpr double kBaseMb = 16, kAnswerBytes = 18;
  const double per_query = 200 + 16 * real(config.query_neighbours);  // bytes, of those in work
  return kBaseMb + 1.1 * (kAnswerBytes * real(Q) + per_query * real(std::min(Q, block))) / kMiB;
}

}  // namespace lte::nn
