#include "lte/data/sample_rows.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <queue>
#include <utility>

#include "lte/base/check.h"

namespace lte::data {
namespace {

/// Stream of the numbers that thinning draws.
constexpr uint64_t kThinningStream = 0x7468696e;

/// Keeps the columns `kept`, ascending, of a table of rows of `columns` entries; none of a tensor
/// that is not there.
template <typename T>
void keep_columns(std::vector<T>* values, size_t columns, const std::vector<int64_t>& kept) {
  if (columns == 0) return;
  const size_t rows = values->size() / columns;
  for (size_t row = 0; row < rows; ++row) {
    for (size_t k = 0; k < kept.size(); ++k)
      (*values)[row * kept.size() + k] = (*values)[row * columns + static_cast<size_t>(kept[k])];
  }
  values->resize(rows * kept.size());
}

/// How many of `count` each group has: in proportion to its size, and at least one. They add up to
/// `count`, unless there are more groups than that.
/// @param sizes  more than `count` in all
std::vector<int64_t> shares_of(std::span<const int64_t> sizes, int64_t count) {
  const int64_t all = std::max(count + 1, std::accumulate(sizes.begin(), sizes.end(), int64_t{0}));
  std::vector<int64_t> shares;
  shares.reserve(sizes.size());
  for (const int64_t size : sizes) shares.push_back(std::max<int64_t>(1, size * count / all));
  // In units of 1 / all.
  const auto lacks = [&](size_t i) { return sizes[i] * count - shares[i] * all; };
  int64_t left = count - std::accumulate(shares.begin(), shares.end(), int64_t{0});
  // Who lacks most gets one more, or who lacks least gives one; of equals the first.
  const int64_t step = left > 0 ? 1 : -1;
  std::priority_queue<std::pair<int64_t, int64_t>> next;  // by what they lack, less their places
  const auto enter = [&](size_t i) {
    if (step > 0 || shares[i] > 1) next.emplace(step * lacks(i), -static_cast<int64_t>(i));
  };
  for (size_t i = 0; i < shares.size(); ++i) enter(i);
  for (; left != 0 && !next.empty(); left -= step) {
    const auto i = static_cast<size_t>(-next.top().second);
    next.pop();
    shares[i] += step;
    enter(i);
  }
  return shares;
}

}  // namespace

std::vector<int64_t> draw_rows(int64_t rows, int64_t count, Rng* rng) {
  const bool all = count == 0 || count >= rows;
  const int64_t taken = all ? rows : count;
  // A random start makes every row equally likely although the runs differ in length by one.
  const int64_t start = all ? 0 : static_cast<int64_t>(rng->below(static_cast<uint64_t>(rows)));
  std::vector<int64_t> drawn(static_cast<size_t>(taken));
  for (int64_t i = 0; i < taken; ++i) {
    const auto begin = static_cast<int64_t>(static_cast<Wide>(i) * static_cast<Wide>(rows) /
                                            static_cast<Wide>(taken));
    const auto end = static_cast<int64_t>(static_cast<Wide>(i + 1) * static_cast<Wide>(rows) /
                                          static_cast<Wide>(taken));
    const int64_t pick =
        all ? begin : begin + static_cast<int64_t>(rng->below(static_cast<uint64_t>(end - begin)));
    drawn[static_cast<size_t>(i)] = (start + pick) % rows;
  }
  std::sort(drawn.begin(), drawn.end());
  return drawn;
}

std::vector<int64_t> draw_scene_rows(std::span<const int32_t> light, int64_t count, Rng* rng) {
  const auto rows = static_cast<int64_t>(light.size());
  if (count == 0 || count >= rows) return draw_rows(rows, 0, rng);
  std::map<int32_t, std::vector<int64_t>> groups;
  for (int64_t i = 0; i < rows; ++i) groups[light[static_cast<size_t>(i)]].push_back(i);
  std::vector<int64_t> sizes;
  sizes.reserve(groups.size());
  for (const auto& [group, members] : groups) sizes.push_back(static_cast<int64_t>(members.size()));
  const std::vector<int64_t> shares = shares_of(sizes, count);
  std::vector<int64_t> drawn;
  size_t next = 0;
  for (const auto& [group, members] : groups) {
    for (const int64_t i : draw_rows(sizes[next], shares[next], rng))
      drawn.push_back(members[static_cast<size_t>(i)]);
    ++next;
  }
  std::sort(drawn.begin(), drawn.end());
  return drawn;
}

std::vector<float> kept_areas(std::span<const int32_t> light, std::span<const float> area,
                              std::span<const int64_t> rows) {
  std::map<int32_t, double> all, kept;
  for (size_t i = 0; i < area.size(); ++i) all[light[i]] += area[i];
  for (const int64_t row : rows)
    kept[light[static_cast<size_t>(row)]] += area[static_cast<size_t>(row)];
  const bool whole = rows.size() == area.size();
  std::vector<float> out;
  out.reserve(rows.size());
  for (const int64_t i : rows) {
    const auto row = static_cast<size_t>(i);
    const double share = kept[light[row]];
    const double factor = whole || share <= 0 ? 1.0 : all[light[row]] / share;
    out.push_back(static_cast<float>(area[row] * factor));
  }
  return out;
}

void thin_scene_points(SceneSample* sample, int64_t count) {
  LTE_CHECK(count >= 0, "scene points to keep: expected 0 (all) or more, got ", count);
  const int64_t M = sample->scene_points();
  if (count == 0 || count >= M) return;
  Rng rng(sample->seed, kThinningStream);
  const std::vector<int64_t> kept = draw_scene_rows(sample->scene_light, count, &rng);
  std::vector<float> area = kept_areas(sample->scene_light, sample->scene_area, kept);
  for_each_scene_tensor(*sample, [&](const TensorRule&, auto& values) {
    keep_columns(&values, static_cast<size_t>(M), kept);
  });
  sample->scene_area = std::move(area);
}

int64_t drop_idle_queries(SceneSample* sample) {
  for (View& view : sample->views) {
    for (size_t i = 0; i < view.mask.size(); ++i) {
      if (max_component(view.albedo[i]) <= 0) view.mask[i] = 0;
    }
  }
  const auto N = static_cast<size_t>(sample->query_points());
  const auto G = static_cast<size_t>(sample->light_groups);
  std::vector<int64_t> kept;
  for (size_t i = 0; i < N; ++i) {
    bool reached = false;
    for (size_t g = 0; g < G && !reached; ++g) {
      reached = max_component(sample->direct[g * N + i]) > 0 ||
                max_component(sample->indirect[g * N + i]) > 0;
    }
    if (reached && max_component(sample->query_albedo[i]) > 0)
      kept.push_back(static_cast<int64_t>(i));
  }
  if (kept.empty() || kept.size() == N) return 0;
  for_each_query_tensor(*sample,
                        [&](const TensorRule&, auto& values) { keep_columns(&values, N, kept); });
  return static_cast<int64_t>(N - kept.size());
}

}  // namespace lte::data
