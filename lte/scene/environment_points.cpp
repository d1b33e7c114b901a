#include "lte/scene/environment_points.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"

namespace lte::scene {
namespace {

/// At least so many look-ups are made along a side of a texel or of a cell, whichever is smaller.
constexpr int kLooks = 4;

/// The sphere in `count` cells of equal area: rings around the Y axis, cut into sectors, so that
/// cells are about as high as wide.
class EqualAreaCells {
 public:
  explicit EqualAreaCells(int64_t count) : count_(count) {
    const auto rings = static_cast<int64_t>(
        std::max(1.0, std::round(M_PI / std::sqrt(4 * M_PI / static_cast<double>(count)))));
    double wanted = 0;
    for (int64_t ring = 0; ring < rings; ++ring) {
      // The area above the ring's lower edge, in cells.
      wanted = static_cast<double>(count) *
               (1 - std::cos(M_PI * static_cast<double>(ring + 1) / static_cast<double>(rings))) /
               2;
      const auto end = ring + 1 == rings ? count : std::llround(wanted);
      if (end > first_.back()) first_.push_back(end);
    }
  }

  int64_t cell(const Vec3& direction) const {
    const double above = static_cast<double>(count_) * (1 - direction.y) / 2;
    const auto after =
        std::upper_bound(first_.begin(), first_.end() - 1, static_cast<int64_t>(above));
    const auto ring = static_cast<size_t>(after - first_.begin()) - 1;
    const int64_t sectors = first_[ring + 1] - first_[ring];
    const double turn = 0.5 + std::atan2(direction.z, direction.x) / (2 * M_PI);
    return first_[ring] +
           std::clamp<int64_t>(static_cast<int64_t>(turn * static_cast<double>(sectors)), 0,
                               sectors - 1);
  }

  /// The direction of a place in a cell; equal areas of `within`, [0, 1]², are equal solid angles.
  Vec3 direction(int64_t cell, const Vec2& within) const {
    const auto after = std::upper_bound(first_.begin(), first_.end(), cell);
    const int64_t begin = *(after - 1), sectors = *after - begin;
    const double above = static_cast<double>(begin) + within.y * static_cast<double>(sectors);
    const double y = 1 - 2 * above / static_cast<double>(count_);
    const double phi =
        2 * M_PI *
        ((static_cast<double>(cell - begin) + within.x) / static_cast<double>(sectors) - 0.5);
    const double across = std::sqrt(std::max(0.0, 1 - y * y));
    return {static_cast<float>(across * std::cos(phi)), static_cast<float>(y),
            static_cast<float>(across * std::sin(phi))};
  }

 private:
  int64_t count_;
  std::vector<int64_t> first_{0};  ///< cell of each ring, then their number
};

struct Sum {
  double rgb[3] = {};
  double weight = 0;

  void add(const Rgb& value, double by) {
    for (int c = 0; c < 3; ++c) rgb[c] += value[c] * by;
    weight += by;
  }
  Rgb mean() const {
    return {static_cast<float>(rgb[0] / weight), static_cast<float>(rgb[1] / weight),
            static_cast<float>(rgb[2] / weight)};
  }
};

/// The mean radiance over each cell. Look-ups go over every texel, so that none is missed, however
/// small, and over the cell, as texels may be larger than it.
std::vector<Rgb> mean_radiance(const Environment& environment, const EqualAreaCells& cells,
                               int64_t count) {
  const EnvironmentMap& map = *environment.map;
  std::vector<Sum> sums(static_cast<size_t>(count));
  const double cell_size = std::sqrt(4 * M_PI / static_cast<double>(count));
  for (int y = 0; y < map.height(); ++y) {
    const double solid_angle = map.solid_angle(y);
    const int looks = std::clamp(
        static_cast<int>(std::ceil(kLooks * std::sqrt(solid_angle) / cell_size)), 1, 256);
    const double weight = solid_angle / (looks * looks);
    for (int x = 0; x < map.width(); ++x) {
      const Rgb& radiance = map.texel(static_cast<size_t>(y) * static_cast<size_t>(map.width()) +
                                      static_cast<size_t>(x));
      for (int look = 0; look < looks * looks; ++look) {
        const Vec2 within{(static_cast<float>(look % looks) + 0.5f) / static_cast<float>(looks),
                          (static_cast<float>(look / looks) + 0.5f) / static_cast<float>(looks)};
        const Vec3 direction = environment.to_world(map.direction(x, y, within));
        sums[static_cast<size_t>(cells.cell(direction))].add(radiance, weight);
      }
    }
  }
  std::vector<Rgb> means;
  Sum all;
  for (int64_t i = 0; i < count; ++i) {
    const Sum& sum = sums[static_cast<size_t>(i)];
    means.push_back(sum.weight > 0 ? environment.radiance * sum.mean()
                                   : environment.radiance_from(cells.direction(i, {0.5f, 0.5f})));
    all.add(means.back(), 4 * M_PI / static_cast<double>(count));
  }
  // A look-up falls on one side or the other of an edge between cells, which may move about a per
  // cent of a sun's light. The fluence of all cells is brought back to the exact one.
  const Rgb exact = fluence(environment);
  Rgb factor{1, 1, 1};
  for (int c = 0; c < 3; ++c)
    if (all.rgb[c] > 0) factor[c] = static_cast<float>(exact[c] / all.rgb[c]);
  for (Rgb& mean : means) mean *= factor;
  return means;
}

}  // namespace

EnvironmentSphere environment_sphere(const Scene& scene) {
  const Bounds bounds = scene.bounds();
  return {bounds.center(), length(bounds.extent()) / 2};
}

void append_environment_points(const Scene& scene, int64_t count, SurfaceSamples* samples) {
  if (count <= 0) return;
  LTE_CHECK(scene.environment, "scene ", scene.name, " has no environment to draw points of");
  const Environment& environment = *scene.environment;
  const EnvironmentSphere sphere = environment_sphere(scene);
  const EqualAreaCells cells(count);
  const std::vector<Rgb> means =
      environment.map ? mean_radiance(environment, cells, count)
                      : std::vector<Rgb>(static_cast<size_t>(count), environment.radiance);
  const float area = 4 * kPi * sphere.radius * sphere.radius / static_cast<float>(count);
  for (int64_t i = 0; i < count; ++i) {
    const Vec3 direction = cells.direction(i, {0.5f, 0.5f});
    samples->position.push_back(sphere.center + direction * sphere.radius);
    samples->normal.push_back(normalize(-direction));
    samples->albedo.push_back({0, 0, 0});
    samples->gloss.push_back({});
    samples->emission.push_back(means[static_cast<size_t>(i)]);
    samples->area.push_back(area);
    samples->light_group.push_back(environment.light_group);
  }
}

}  // namespace lte::scene
