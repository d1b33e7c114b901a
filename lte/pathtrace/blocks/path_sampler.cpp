#include "lte/pathtrace/blocks/path_sampler.h"

#include "lte/pathtrace/blocks/path_kernels.h"

namespace lte::pathtrace {
namespace {

/// Independent numbers of a path: far more than the vertices of the longest need.
constexpr uint64_t kNumbersPerPath = 1 << 16;

}  // namespace

PathSampler::PathSampler(Sampling sampling, int set_size, int leading)
    : sampling_(sampling),
      joint_(set_size >= kJointSize),
      leading_(leading),
      last_index_(std::bit_ceil(static_cast<uint32_t>(set_size)) - 1),
      scrambles_(0) {}

void PathSampler::start_stream(uint64_t seed, uint64_t stream) {
  scrambles_ = Rng(seed, stream);
  independent_ = hash_combine(mix_bits(seed + 1), stream);
  number_ = 0;
}

void PathSampler::start_set() {
  const auto set = static_cast<size_t>(sets_++);
  for (auto& seeds : scramble_seeds_) seeds[set] = scrambles_.next_u32();
  for (auto& seeds : shuffle_seeds_) seeds[set] = scrambles_.next_u32();
  index_ = 0;
}

void PathSampler::add_path() {
  const auto path = static_cast<size_t>(paths_++);
  index_of_path_[path] = index_++;
  set_of_path_[path] = sets_ - 1;
  key_of_path_[path] = independent_ + number_++ * (kNumbersPerPath * 0x9e3779b97f4a7c15ULL);
}

void PathSampler::clear() {
  if (sets_ > 1) {
    const auto last = static_cast<size_t>(sets_ - 1);
    for (auto& seeds : scramble_seeds_) seeds[0] = seeds[last];
    for (auto& seeds : shuffle_seeds_) seeds[0] = seeds[last];
    sets_ = 1;
  }
  paths_ = 0;
}

void PathSampler::draw(int vertex, int first, int numbers, const int32_t* path, int count,
                       uint32_t* const* out) {
  // The direction out of a vertex counts as that vertex's, the other numbers as the next one's.
  const bool stratified = vertex < kStratifiedVertices + (first < 2 && vertex > 0 ? 1 : 0);
  if (sampling_ == Sampling::Random || !stratified) {
    for (int i = 0; i < count; ++i)
      lane_key_[static_cast<size_t>(i)] = key_of_path_[static_cast<size_t>(path[i])];
    for (int k = 0; k < numbers; ++k) {
      independent_numbers(lane_key_.data(), count,
                          static_cast<uint64_t>(vertex * 8 + first + k) + 1, out[k]);
    }
    return;
  }
  for (int i = 0; i < count; ++i) {
    const auto from = static_cast<size_t>(path[i]), lane = static_cast<size_t>(i);
    lane_index_[lane] = index_of_path_[from];
    lane_set_[lane] = set_of_path_[from];
  }
  SobolLanes lanes{lane_index_.data(), lane_set_.data(), count, last_index_};
  if (!joint_ || vertex == 0) {
    shuffled_indices(lanes, shuffle_seeds_[static_cast<size_t>(vertex)].data(), last_index_,
                     lane_shuffled_.data());
    lanes.index = lane_shuffled_.data();
  }
  const int slot = vertex == 0 ? first : kFirst + (vertex - 1) * kPerVertex + first;
  const int dimension = joint_ && vertex > 0 ? leading_ + slot - kFirst : first;
  const auto* const seeds = &scramble_seeds_[static_cast<size_t>(slot)];
  for (int k = 0; k < numbers; ++k) scrambled_sobol(lanes, dimension + k, seeds[k].data(), out[k]);
}

void PathSampler::light(int vertex, const int32_t* path, int count, LightNumbers* out) {
  uint32_t* const numbers[] = {out->point_x, out->point_y, out->choice};
  draw(vertex, vertex == 0 ? 0 : 2, 3, path, count, numbers);
}

void PathSampler::direction(int vertex, const int32_t* path, int count, DirectionNumbers* out) {
  uint32_t* const numbers[] = {out->x, out->y};
  draw(vertex + 1, 0, 2, path, count, numbers);
}

void PathSampler::roulette(int vertex, const int32_t* path, int count, uint32_t* out) {
  uint32_t* const numbers[] = {out};
  draw(vertex, 5, 1, path, count, numbers);
}

}  // namespace lte::pathtrace
