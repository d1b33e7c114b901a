#include "lte/pathtrace/direct_light.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/base/random.h"
#include "lte/pathtrace/balance_heuristic.h"
#include "lte/pathtrace/blocks/path_kernels.h"
#include "lte/pathtrace/blocks/ray_packets.h"
#include "lte/pathtrace/embree_scene.h"
#include "lte/pathtrace/lights/light_lanes.h"
#include "lte/pathtrace/ray_offset.h"
#include "lte/pathtrace/transport/irradiance_kernel.h"

namespace lte::pathtrace {
namespace {

constexpr int kMaxSamples = 1 << 26;
/// Points that a thread takes at once.
constexpr int64_t kGrain = 256;
/// Light samples stand off their surface already; this only covers rounding of the distance.
constexpr float kShortened = 1 - 0x1p-20f;
/// Random numbers of a sample: the point on the light, the light, and the direction.
constexpr int kNumbers = 5;
// Others draw from the set of a SampleNumber, too.
constexpr uint64_t kOfDirectLight = 51;

/// The samples of one kind, light or hemisphere, that the lanes of a block hold. A lane's numbers
/// are a point of a scrambled Sobol set, one for each half of a query point.
struct Samples {
  int size = 0;
  Lanes3 position, normal;             ///< of the query point
  alignas(64) int32_t set[kBlock];     ///< slot of the half
  alignas(64) uint32_t index[kBlock];  ///< in the set
  alignas(64) float scale[kBlock];     ///< what the sample's value is multiplied by: 1 / samples
};

/// A sum in double.
struct Sum {
  double x = 0, y = 0, z = 0;
  void add(double r, double g, double b) {
    x += r;
    y += g;
    z += b;
  }
};

/// Half of a point's samples, or all of them. Each kind has a sum of its own: its order is that of
/// the samples, wherever a block ends.
struct Half {
  int64_t point;
  Sum light, sky;

  Sum all() const { return {light.x + sky.x, light.y + sky.y, light.z + sky.z}; }
};

class DirectEstimator {
 public:
  DirectEstimator(const Bvh& bvh, const Lights& lights, const DirectPoints& points,
                  std::span<const int32_t> samples, const DirectOptions& options)
      : handles_(bvh.handles()),
        scene_(bvh.scene()),
        lights_(lights),
        points_(points),
        samples_(samples),
        options_(options),
        half_extent_(0.5f * max_component(bvh.bounds().extent())),
        share_(lights.can_be_hit() ? options.hemisphere_share : 0) {}

  int64_t rays_traced() const { return rays_traced_; }

  void run(int64_t begin, int64_t end, DirectLight* out) {
    for (int64_t i = begin; i < end; ++i) {
      const int32_t n = samples_[static_cast<size_t>(i)];
      if (n == 0) continue;
      const int32_t first = options_.variance ? n / 2 : 0;
      if (first > 0) add_half(i, 0, first, n);
      add_half(i, 1, n - first, n);
    }
    flush();
    store(out);
  }

 private:
  /// Appends `count` of the point's `all` light samples, and their part of its hemisphere's.
  void add_half(int64_t i, int which, int32_t count, int32_t all) {
    const auto at = static_cast<size_t>(i);
    if (seeded_ == kBlock) flush();
    auto half = static_cast<int32_t>(halves_.size());
    halves_.push_back({i, {}, {}});
    int32_t slot = -1;
    // Places of a tile share no set here: two or three dimensions are spread best by one of each.
    const bool goes_on = !points_.numbers.empty();
    Rng random = goes_on ? Rng(hash_combine(points_.numbers[at].set, kOfDirectLight),
                               points_.numbers[at].place)
                         : Rng(hash_combine(options_.seed, static_cast<uint64_t>(which) + 1),
                               points_.streams[at]);
    const uint32_t first = goes_on ? points_.numbers[at].number : 0;
    const uint32_t end = first + static_cast<uint32_t>(count);
    std::array<uint32_t, kNumbers> seeds;
    for (uint32_t& seed : seeds) seed = random.next_u32();
    const double rounding = double{random.uniform()};
    const auto rays_beside = [&](uint32_t light_samples) {
      if (options_.hemisphere_elsewhere) return 0U;
      return static_cast<uint32_t>(std::floor(double{share_} * light_samples + rounding));
    };
    const Vec3& side =
        points_.geometric_normals.empty() ? points_.normals[at] : points_.geometric_normals[at];
    const Vec3 origin = offset_origin(points_.positions[at], side, half_extent_) - handles_.origin;
    const auto add = [&](Samples* block, uint32_t k) {
      if (block->size == kBlock) {
        flush();
        slot = -1;
      }
      if (slot < 0) {
        slot = seeded_++;
        half_of_slot_[static_cast<size_t>(slot)] = half;
        for (size_t n = 0; n < kNumbers; ++n) seeds_[n][static_cast<size_t>(slot)] = seeds[n];
      }
      const int lane = block->size++;
      block->position.put(lane, origin);
      block->normal.put(lane, points_.normals[at]);
      block->set[lane] = slot;
      block->index[lane] = k;
      block->scale[lane] = 1 / static_cast<float>(all);
      last_index_ = std::max(last_index_, k);
    };
    for (uint32_t k = first; k < end; ++k) add(&light_, k);
    for (uint32_t k = rays_beside(first); k < rays_beside(end); ++k) add(&sky_, k);
  }

  void flush() {
    if (light_.size > 0) sample_lights();
    if (sky_.size > 0) sample_hemisphere();
    light_.size = sky_.size = seeded_ = 0;
    last_index_ = 0;
  }

  void draw(const Samples& from, size_t number, int dimension, uint32_t* out) {
    scrambled_sobol({from.index, from.set, from.size, last_index_}, dimension,
                    seeds_[number].data(), out);
  }

  void collect(const Samples& from, int lane, Sum Half::*kind, const Rgb& value) {
    const int32_t half = half_of_slot_[static_cast<size_t>(from.set[lane])];
    (halves_[static_cast<size_t>(half)].*kind).add(value.x, value.y, value.z);
  }

  bool from_below(const Samples& samples, int lane, const Vec3& direction) const {
    if (points_.geometric_normals.empty()) return false;
    const int32_t half = half_of_slot_[static_cast<size_t>(samples.set[lane])];
    const auto point = static_cast<size_t>(halves_[static_cast<size_t>(half)].point);
    return !(dot(points_.geometric_normals[point], direction) > 0);
  }

  void sample_lights() {
    draw(light_, 0, 0, numbers_.point_x);
    draw(light_, 1, 1, numbers_.point_y);
    draw(light_, 2, 2, numbers_.choice);
    sample_light_lanes(lights_, light_.position, light_.normal, numbers_, light_.size, &drawn_);
    int kept = 0;
    for (int lane = 0; lane < light_.size; ++lane) {
      const Vec3 direction = drawn_.direction.at(lane);
      const float pdf = drawn_.pdf[lane], cosine = dot(light_.normal.at(lane), direction);
      if (pdf == 0 || !(cosine > 0) || from_below(light_, lane, direction)) continue;
      const float density = balance_density(pdf, share_ * cosine / kPi);
      const Rgb value = drawn_.radiance.at(lane) * (light_.scale[lane] * cosine / density);
      if (!(max_component(value) > 0)) continue;
      shadows_.origin.put(kept, light_.position.at(lane));
      shadows_.direction.put(kept, direction);
      shadows_.value.put(kept, value);
      shadows_.t_max[kept] = drawn_.distance[lane] * kShortened;
      shadows_.path[kept++] = lane;
    }
    shadows_.size = kept;
    rays_traced_ += kept;
    occluded(handles_.top, handles_.packet_width, shadows_, stopped_);
    for (int ray = 0; ray < kept; ++ray) {
      if (stopped_[ray] == 0)
        collect(light_, shadows_.path[ray], &Half::light, shadows_.value.at(ray));
    }
  }

  void sample_hemisphere() {
    draw(sky_, 3, 0, numbers_.point_x);
    draw(sky_, 4, 1, numbers_.point_y);
    cosine_directions(numbers_.point_x, numbers_.point_y, sky_.size, sky_.normal, &directions_,
                      pdf_);
    rays_traced_ += sky_.size;
    intersect(handles_.top, handles_.packet_width, sky_.position, directions_, sky_.size, &hits_);
    for (int lane = 0; lane < sky_.size; ++lane) {
      float light_pdf = 0;
      if (from_below(sky_, lane, directions_.at(lane))) continue;
      const Rgb radiance = seen(lane, &light_pdf);
      if (!(max_component(radiance) > 0)) continue;
      // The cosine over π is the density of the direction.
      const float weight = kPi * pdf_[lane] / balance_density(light_pdf, share_ * pdf_[lane]);
      collect(sky_, lane, &Half::sky, radiance * (weight * sky_.scale[lane]));
    }
  }

  /// Radiance from what a ray of the hemisphere has met, and the density of light samples there.
  Rgb seen(int lane, float* light_pdf) const {
    const Vec3 direction = directions_.at(lane), normal = sky_.normal.at(lane);
    const int instance = hits_.instance[lane];
    if (instance == scene::kNone) {
      if (!lights_.has_environment()) return {};
      const EnvironmentSample sky = lights_.environment().evaluate(normal, direction);
      *light_pdf = lights_.environment_pdf(sky);
      return sky.radiance;
    }
    const InstanceRecord& record = handles_.instances[static_cast<size_t>(instance)];
    if (!record.emissive) return {};
    const float cos_front = -dot(frame_normal(record, hits_.normal.at(lane)), direction);
    if (!(cos_front > 0 || record.two_sided)) return {};
    Rgb albedo, emission = record.emission;
    if (!record.uniform) {
      scene::evaluate_appearance(scene_, instance, hits_.triangle[lane], hits_.u[lane],
                                 hits_.v[lane], 0, &albedo, &emission);
    }
    const float distance = hits_.t[lane];
    *light_pdf = lights_.pdf(sky_.position.at(lane), normal, instance, hits_.triangle[lane],
                             distance * distance, std::fabs(cos_front));
    return emission;
  }

  void store(DirectLight* out) {
    for (size_t h = 0; h < halves_.size(); ++h) {
      const auto i = static_cast<size_t>(halves_[h].point);
      Sum sum = halves_[h].all();
      const bool two = h + 1 < halves_.size() && halves_[h + 1].point == halves_[h].point;
      if (two) {
        const Sum second = halves_[++h].all();
        out->variance[i] = variance_of_mean(sum, second, samples_[i]);
        sum.add(second.x, second.y, second.z);
      } else if (options_.variance) {
        out->variance[i] = std::numeric_limits<float>::infinity();
      }
      out->irradiance[i] = {static_cast<float>(sum.x), static_cast<float>(sum.y),
                            static_cast<float>(sum.z)};
    }
    halves_.clear();
  }

  /// Of all samples of a point, from the shares of their mean that two halves have brought: means
  /// of shares w and 1 − w differ by a variance of σ² (1/w + 1/(1 − w)), with σ² that of the whole.
  static float variance_of_mean(const Sum& a, const Sum& b, int32_t samples) {
    const auto luminance_of = [](const Sum& s) {
      return luminance({static_cast<float>(s.x), static_cast<float>(s.y), static_cast<float>(s.z)});
    };
    const int32_t of_a = samples / 2;
    const double share_a = double{1} * of_a / samples, share_b = 1 - share_a;
    const double apart = luminance_of(a) / share_a - luminance_of(b) / share_b;
    return static_cast<float>(apart * apart * share_a * share_b);
  }

  const Bvh::Handles& handles_;
  const scene::Scene& scene_;
  const Lights& lights_;
  const DirectPoints& points_;
  std::span<const int32_t> samples_;
  const DirectOptions& options_;
  const float half_extent_, share_;
  int64_t rays_traced_ = 0;

  std::vector<Half> halves_;
  int seeded_ = 0;           ///< halves that have samples in this block
  uint32_t last_index_ = 0;  ///< largest in the block
  std::array<int32_t, kBlock> half_of_slot_;
  std::array<std::array<uint32_t, kBlock>, kNumbers> seeds_;

  Samples light_, sky_;
  LightNumbers numbers_;
  LightBlock drawn_;
  ShadowBlock shadows_;
  Lanes3 directions_;
  alignas(64) float pdf_[kBlock];
  HitBlock hits_;
  alignas(64) int32_t stopped_[kBlock];
};

}  // namespace

DirectLight estimate_direct(const Bvh& bvh, const Lights& lights, const DirectPoints& points,
                            std::span<const int32_t> samples, const DirectOptions& options) {
  LTE_CHECK(&bvh.scene() == &lights.scene(), "the BVH and the lights are of two scenes");
  check_points(points.positions, points.normals);
  const size_t count = points.positions.size();
  LTE_CHECK(points.streams.size() + points.numbers.size() == count &&
                (points.streams.empty() || points.numbers.empty()) && samples.size() == count,
            "direct light needs a stream or a number, and a count, a point: got ", count,
            " positions, ", points.streams.size(), " streams, ", points.numbers.size(),
            " numbers and ", samples.size(), " counts");
  LTE_CHECK(!options.variance || points.numbers.empty(),
            "direct light of samples that go on has no variance");
  if (!points.geometric_normals.empty()) check_points(points.positions, points.geometric_normals);
  LTE_CHECK(options.hemisphere_share >= 0 && options.hemisphere_share <= 1,
            "hemisphere_share must be 0 to 1, got ", options.hemisphere_share);
  for (size_t i = 0; i < samples.size(); ++i) {
    LTE_CHECK(samples[i] >= 0 && samples[i] <= kMaxSamples, "samples of point ", i,
              " must be 0 to ", kMaxSamples, ", got ", samples[i]);
  }
  DirectLight out;
  out.irradiance.resize(samples.size());
  if (options.variance) out.variance.resize(samples.size());
  if (lights.empty()) return out;
  std::atomic<int64_t> rays_traced{0};
  parallel_for(static_cast<int64_t>(samples.size()), kGrain, [&](int64_t begin, int64_t end) {
    const auto estimator = std::make_unique<DirectEstimator>(bvh, lights, points, samples, options);
    estimator->run(begin, end, &out);
    rays_traced += estimator->rays_traced();
  });
  out.rays_traced = rays_traced;
  return out;
}

}  // namespace lte::pathtrace
