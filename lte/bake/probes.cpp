#include "lte/bake/probes.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/balance_heuristic.h"
#include "lte/pathtrace/blocks/path_sampler.h"
#include "lte/pathtrace/transport/transport_impl.h"
#include "lte/scene/surface.h"

namespace lte::bake {
namespace {

using namespace pathtrace;

constexpr int kMaxCount = 256, kMaxRays = 1 << 20, kAutoCells = 16, kRouletteDepth = 3;
/// Light samples end short of their surface.
constexpr float kShadowShare = 1 - 0x1p-12f;
constexpr float kSphereDensity = 1 / (4 * kPi);

Vec3 sphere_direction(const Vec2& u) {
  const float z = 1 - 2 * u.x, radius = std::sqrt(std::max(0.0f, 1 - z * z));
  return {radius * std::cos(2 * kPi * u.y), radius * std::sin(2 * kPi * u.y), z};
}

struct Sums {
  std::array<std::array<double, 3>, kShCoefficients> radiance{};
  std::array<std::array<double, 3>, kCubeSides> irradiance{};
  std::array<double, kCubeSides> weight{}, distance{}, distance2{};
  int64_t back_faces = 0;

  /// Adds radiance times solid angle that arrives from a direction.
  void add(const Vec3& direction, const Rgb& value) {
    const std::array<float, kShCoefficients> basis = sh_basis(direction);
    for (size_t k = 0; k < basis.size(); ++k) add_to(&radiance[k], value * basis[k]);
    for (int axis = 0; axis < 3; ++axis) {
      const size_t side = side_of(direction, axis);
      add_to(&irradiance[side], value * std::fabs(direction[axis]));
    }
  }
  void add_distance(const Vec3& direction, double metres) {
    for (int axis = 0; axis < 3; ++axis) {
      const size_t side = side_of(direction, axis);
      const double share = double{direction[axis]} * direction[axis];
      weight[side] += share;
      distance[side] += share * metres;
      distance2[side] += share * metres * metres;
    }
  }

 private:
  static size_t side_of(const Vec3& direction, int axis) {
    return 2 * static_cast<size_t>(axis) + (direction[axis] > 0 ? 1 : 0);
  }
  static void add_to(std::array<double, 3>* sum, const Rgb& value) {
    for (size_t c = 0; c < 3; ++c) (*sum)[c] += value[static_cast<int>(c)];
  }
};

Rgb to_rgb(const std::array<double, 3>& sum, double scale) {
  return {static_cast<float>(sum[0] * scale), static_cast<float>(sum[1] * scale),
          static_cast<float>(sum[2] * scale)};
}

/// Traces the probes of a thread.
class ProbeTracer : public LightSink {
  /// Has the tracer see what first rays meet.
  struct FirstHits {
    ProbeTracer* tracer = nullptr;
    void nearest(int /*depth*/, const PathBlock&) {}
    void shadow(const ShadowBlock&) {}
    void met(int depth, const PathBlock& paths, const HitBlock& hits) const {
      for (int lane = 0; depth == 1 && lane < paths.size; ++lane)
        tracer->add_met(lane, paths.direction.at(lane), hits);
    }
  };

 public:
  ProbeTracer(const Bvh& bvh, const Lights& lights, const ProbeOptions& options)
      : bvh_(bvh),
        lights_(lights),
        options_(options),
        frame_(frame_origin(bvh.bounds())),
        diagonal_(length(bvh.bounds().extent())),
        sampler_(Sampling::Sobol, options.rays),
        // Light of depth 2 may be unwanted; the last ray's hit would not be seen.
        transport_(bvh, lights, std::max(2, options.max_depth), kRouletteDepth, *this, {this}) {}

  Probe trace(const Vec3& position, uint64_t number) {
    sums_ = {};
    position_ = position;
    sampler_.start_stream(options_.seed, number);
    sampler_.start_set();
    for (int k = 0; k < options_.rays; ++k) {
      if (sampler_.paths() == kBlock) flush();
      sampler_.add_path();
    }
    flush();
    return result();
  }

  void add(int depth, std::span<const Contribution> contributions) override {
    // Of the first hit: add_met() and add_light_sample().
    if (depth == 1 || depth > options_.max_depth) return;
    for (const Contribution& c : contributions)
      sums_.add(directions_[static_cast<size_t>(c.path)], c.value * (1 / kSphereDensity));
  }

 private:
  void flush() {
    const int count = sampler_.paths();
    std::array<int32_t, kBlock> all;
    for (int32_t i = 0; i < kBlock; ++i) all[static_cast<size_t>(i)] = i;
    sampler_.direction(0, all.data(), count, &numbers_);
    sampler_.light(0, all.data(), count, &light_numbers_);
    for (int i = 0; i < count; ++i) {
      const Vec3 direction = sphere_direction({to_unit(numbers_.x[i]), to_unit(numbers_.y[i])});
      directions_[static_cast<size_t>(i)] = direction;
      transport_.start().origin.put(i, position_ - frame_);
      transport_.start().direction.put(i, direction);
      if (options_.direct && !lights_.empty()) add_light_sample(i);
    }
    if (lights_.empty()) {
      meet(count);
    } else {
      transport_.trace_from_camera(sampler_);
    }
    sampler_.clear();
  }

  /// What directions meet where there is no light to trace.
  void meet(int count) {
    const Bvh::Handles& handles = bvh_.handles();
    PathBlock& paths = transport_.start();
    intersect(handles.top, handles.packet_width, paths.origin, paths.direction, count, &hits_);
    for (int lane = 0; lane < count; ++lane) add_met(lane, paths.direction.at(lane), hits_);
  }

  /// What a direction meets: its distance, its side, and its own light.
  void add_met(int lane, const Vec3& direction, const HitBlock& hits) {
    const int hit = hits.instance[lane];
    const float distance = hits.t[lane];
    sums_.add_distance(direction, hit == scene::kNone ? diagonal_ : std::min(distance, diagonal_));
    float light_density = 0;
    Rgb radiance;
    if (hit == scene::kNone) {
      if (!lights_.has_environment()) return;
      const EnvironmentSample sky = lights_.environment().evaluate({}, direction);
      light_density = lights_.environment_pdf(sky);
      radiance = sky.radiance;
    } else {
      const scene::Scene& scene = bvh_.scene();
      const auto& instance = scene.instances[static_cast<size_t>(hit)];
      const auto& mesh = scene.meshes[static_cast<size_t>(instance.mesh)];
      const bool two_sided = scene.materials[static_cast<size_t>(mesh.material)].double_sided;
      const Vec3 normal =
          frame_normal(bvh_.handles().instances[static_cast<size_t>(hit)], hits.normal.at(lane));
      const float cosine = -dot(normal, direction);
      if (cosine <= 0 && !two_sided) {
        ++sums_.back_faces;
        return;
      }
      if (instance.light_group == scene::kNone) return;
      Rgb albedo;
      scene::evaluate_appearance(scene, hit, hits.triangle[lane], hits.u[lane], hits.v[lane], 0,
                                 &albedo, &radiance);
      light_density = lights_.pdf(position_ - frame_, {}, hit, hits.triangle[lane],
                                  distance * distance, std::fabs(cosine));
    }
    if (options_.direct) {
      const float density = balance_density(light_density, kSphereDensity);
      sums_.add(direction, radiance * (1 / density));
    }
  }

  void add_light_sample(int i) {
    const LightSample light =
        lights_.sample(position_, {}, light_numbers_.choice[i] * 0x1p-32,
                       {to_unit(light_numbers_.point_x[i]), to_unit(light_numbers_.point_y[i])});
    if (!(light.pdf > 0) || !(max_component(light.radiance) > 0)) return;
    if (bvh_.occluded({position_, light.direction, 0, light.distance * kShadowShare})) return;
    const float density = balance_density(light.delta ? -light.pdf : light.pdf, kSphereDensity);
    sums_.add(light.direction, light.radiance * (1 / density));
  }

  Probe result() const {
    Probe probe;
    const double share = 1.0 / options_.rays;
    for (size_t k = 0; k < probe.radiance.size(); ++k)
      probe.radiance[k] = to_rgb(sums_.radiance[k], share);
    for (size_t side = 0; side < probe.irradiance.size(); ++side) {
      probe.irradiance[side] = to_rgb(sums_.irradiance[side], share);
      const double weight = std::max(sums_.weight[side], 1e-30);
      probe.distance[side] = static_cast<float>(sums_.distance[side] / weight);
      probe.distance2[side] = static_cast<float>(sums_.distance2[side] / weight);
    }
    probe.back_faces = static_cast<float>(static_cast<double>(sums_.back_faces) * share);
    probe.valid = probe.back_faces < kMaxBackFaces;
    return probe;
  }

  const Bvh& bvh_;
  const Lights& lights_;
  const ProbeOptions& options_;
  const Vec3 frame_;
  const float diagonal_;
  PathSampler sampler_;
  BasicTransport<FirstHits> transport_;
  Sums sums_;
  Vec3 position_;
  HitBlock hits_;
  std::array<Vec3, kBlock> directions_;
  DirectionNumbers numbers_;
  LightNumbers light_numbers_;
};

/// Gives an invalid probe the mean light of those of its six neighbors that have some.
bool fill_from_neighbors(const ProbeGrid& grid, const std::vector<Probe>& from,
                         const std::vector<uint8_t>& known, int64_t probe, Probe* out) {
  const std::array<int64_t, 3> stride{1, grid.counts[0], int64_t{grid.counts[0]} * grid.counts[1]};
  int found = 0;
  Probe sum;
  for (size_t axis = 0; axis < 3; ++axis) {
    const int64_t place = probe / stride[axis] % grid.counts[axis];
    for (const int step : {-1, 1}) {
      if (place + step < 0 || place + step >= grid.counts[axis]) continue;
      const auto next = static_cast<size_t>(probe + step * stride[axis]);
      if (known[next] == 0) continue;
      ++found;
      for (size_t k = 0; k < sum.radiance.size(); ++k) sum.radiance[k] += from[next].radiance[k];
      for (size_t k = 0; k < sum.irradiance.size(); ++k)
        sum.irradiance[k] += from[next].irradiance[k];
    }
  }
  if (found == 0) return false;
  const float share = 1 / static_cast<float>(found);
  for (size_t k = 0; k < sum.radiance.size(); ++k) out->radiance[k] = sum.radiance[k] * share;
  for (size_t k = 0; k < sum.irradiance.size(); ++k) out->irradiance[k] = sum.irradiance[k] * share;
  return true;
}

void fill_invalid(ProbeVolume* volume) {
  std::vector<uint8_t> known;
  for (const Probe& probe : volume->probes) known.push_back(probe.valid ? 1 : 0);
  for (int64_t left = volume->invalid; left > 0;) {
    const std::vector<Probe> before = volume->probes;
    const std::vector<uint8_t> known_before = known;
    for (int64_t i = 0; i < volume->grid.size(); ++i) {
      const auto at = static_cast<size_t>(i);
      if (known_before[at] != 0 ||
          !fill_from_neighbors(volume->grid, before, known_before, i, &volume->probes[at]))
        continue;
      known[at] = 1;
      --left;
    }
  }
}

}  // namespace

Vec3 ProbeGrid::position(int64_t probe) const {
  const Vec3 extent = bounds.extent();
  Vec3 out;
  for (int axis = 0; axis < 3; ++axis) {
    const int count = counts[static_cast<size_t>(axis)];
    const auto place = static_cast<float>(probe % count);
    probe /= count;
    out[axis] = bounds.low[axis] + extent[axis] * (place + 0.5f) / static_cast<float>(count);
  }
  return out;
}

ProbeGrid parse_probe_grid(const std::string& text, const Bounds& scene) {
  LTE_CHECK(!scene.empty(), "--probes: the scene has no surfaces");
  ProbeGrid grid;
  grid.bounds = scene;
  if (text == "auto") {
    const Vec3 extent = scene.extent();
    const float cell = max_component(extent) / kAutoCells;
    for (int axis = 0; axis < 3; ++axis) {
      grid.counts[static_cast<size_t>(axis)] =
          cell > 0 ? std::max(1, static_cast<int>(std::lround(extent[axis] / cell))) : 1;
    }
    return grid;
  }
  const char *at = text.data(), *const end = text.data() + text.size();
  bool good = true;
  for (size_t axis = 0; axis < 3 && good; ++axis) {
    if (axis > 0) good = at < end && *at++ == 'x';
    const auto [next, error] = std::from_chars(at, end, grid.counts[axis]);
    good = good && error == std::errc{} && grid.counts[axis] >= 1 && grid.counts[axis] <= kMaxCount;
    at = next;
  }
  LTE_CHECK(good && at == end, "--probes: expected auto or NXxNYxNZ of numbers from 1 to ",
            kMaxCount, ", got ", text);
  return grid;
}

std::array<float, kShCoefficients> sh_basis(const Vec3& d) {
  return {0.28209479f,
          0.48860251f * d.y,
          0.48860251f * d.z,
          0.48860251f * d.x,
          1.09254843f * d.x * d.y,
          1.09254843f * d.y * d.z,
          0.31539157f * (3 * d.z * d.z - 1),
          1.09254843f * d.x * d.z,
          0.54627422f * (d.x * d.x - d.y * d.y)};
}

Rgb sh_irradiance(const Probe& probe, const Vec3& normal) {
  // The cosine's own coefficients, by order.
  constexpr std::array<float, kShCoefficients> kCosine{
      kPi, 2 * kPi / 3, 2 * kPi / 3, 2 * kPi / 3, kPi / 4, kPi / 4, kPi / 4, kPi / 4, kPi / 4};
  const std::array<float, kShCoefficients> basis = sh_basis(normal);
  Rgb out;
  for (size_t k = 0; k < basis.size(); ++k) out += probe.radiance[k] * (basis[k] * kCosine[k]);
  return max(out, {});
}

ProbeVolume bake_probes(const Bvh& bvh, const Lights& lights, const ProbeGrid& grid,
                        const ProbeOptions& options) {
  LTE_CHECK(&bvh.scene() == &lights.scene(), "the BVH and the lights are of two scenes");
  LTE_CHECK(options.rays >= 1 && options.rays <= kMaxRays, "rays of probes must be 1 to ", kMaxRays,
            ", got ", options.rays);
  LTE_CHECK(options.max_depth >= 1, "max_depth must be at least 1, got ", options.max_depth);
  ProbeVolume volume;
  volume.grid = grid;
  volume.probes.resize(static_cast<size_t>(grid.size()));
  parallel_for(grid.size(), 4, [&](int64_t begin, int64_t end) {
    const auto tracer = std::make_unique<ProbeTracer>(bvh, lights, options);
    for (int64_t i = begin; i < end; ++i)
      volume.probes[static_cast<size_t>(i)] =
          tracer->trace(grid.position(i), static_cast<uint64_t>(i));
    if (options.done) options.done(end - begin);
  });
  volume.invalid = std::count_if(volume.probes.begin(), volume.probes.end(),
                                 [](const Probe& probe) { return !probe.valid; });
  LTE_CHECK(volume.invalid < grid.size(), "--probes: all ", grid.size(),
            " probes are in walls or see back faces only; take more of them");
  fill_invalid(&volume);
  return volume;
}

}  // namespace lte::bake
