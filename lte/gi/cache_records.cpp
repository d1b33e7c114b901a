#include "lte/gi/cache_records.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/gi/gather.h"
#include "lte/pathtrace/direct_light.h"
#include "lte/pathtrace/ray_offset.h"
#include "lte/scene/sampler.h"

namespace lte::gi {
namespace {

constexpr double kEmissiveShare = 0.1;
constexpr int64_t kRuns = 64;  ///< of points that a thread takes at a time
// Points of a record lie so near its first, in edges of the square that all of them stand for, and
// so near its plane; their normals differ by less than 26 degrees. Farther ones would darken what
// lies open by what lies in corners.
constexpr float kApart = 1, kOffPlane = 0.05f, kMinCosine = 0.9f;
// Nor may one have so many times as much room above it as another.
constexpr float kAsOpen = 2;

/// Whether a straight line over the surface leads from `a` to `b`: floors go on below what stands
/// on them, where no light comes.
bool sees(const pathtrace::Bvh& bvh, const Vec3& a, const Vec3& b, const Vec3& normal) {
  const float magnitude = 0.5f * max_component(bvh.bounds().extent());
  pathtrace::Ray ray;
  ray.origin = pathtrace::offset_origin(a, normal, magnitude);
  ray.direction = pathtrace::offset_origin(b, normal, magnitude) - ray.origin;
  ray.t_max = 1;
  return !bvh.occluded(ray);
}

/// How far from point `a` the next sheet is, at most `most`.
float clearance(const pathtrace::Bvh& bvh, const Vec3& a, const Vec3& normal, float most) {
  pathtrace::Ray ray;
  ray.origin = pathtrace::offset_origin(a, normal, 0.5f * max_component(bvh.bounds().extent()));
  ray.direction = normal;
  ray.t_max = most;
  return std::min(bvh.intersect(ray).t, most);
}

/// Whether as little stands above one point as above the other: below a bed a floor is dark.
bool as_open(const pathtrace::Bvh& bvh, const Vec3& a, const Vec3& b, const Vec3& normal,
             float edge) {
  const float above = clearance(bvh, a, normal, edge), other = clearance(bvh, b, normal, edge);
  return above <= kAsOpen * other && other <= kAsOpen * above;
}

/// Whether point `b` lies on the same level piece of surface as point `a`.
bool joins(const pathtrace::Bvh& bvh, const scene::SurfaceSamples& samples, size_t a, size_t b) {
  if (samples.area[a] != samples.area[b]) return false;
  if (dot(samples.normal[a], samples.normal[b]) < kMinCosine) return false;
  const float edge = std::sqrt(kRecordPoints * samples.area[a]);
  const Vec3 between = samples.position[b] - samples.position[a];
  return dot(between, between) < kApart * kApart * edge * edge &&
         std::fabs(dot(between, samples.normal[a])) < kOffPlane * edge &&
         sees(bvh, samples.position[a], samples.position[b], samples.normal[a]) &&
         sees(bvh, samples.position[a], samples.position[b], -samples.normal[a]) &&
         as_open(bvh, samples.position[a], samples.position[b], samples.normal[a], edge) &&
         as_open(bvh, samples.position[a], samples.position[b], -samples.normal[a], edge);
}

bool usable(const scene::SurfaceSamples& samples, size_t i) {
  return dot(samples.normal[i], samples.normal[i]) > 0.5f && samples.area[i] > 0;
}

/// Adds both sides of points `begin` to `end` − 1. The record stands at the one nearest their
/// middle.
void add_records(const scene::SurfaceSamples& samples, size_t begin, size_t end,
                 CacheRecords* out) {
  Vec3 middle;
  Rgb albedo;
  const float scale = 1 / static_cast<float>(end - begin);
  for (size_t i = begin; i < end; ++i) {
    middle += samples.position[i] * scale;
    albedo += samples.albedo[i] * scale;
  }
  const auto far = [&](size_t i) {
    const Vec3 d = samples.position[i] - middle;
    return dot(d, d);
  };
  size_t nearest = begin;
  for (size_t i = begin; i < end; ++i) nearest = far(i) < far(nearest) ? i : nearest;
  for (const float side : {1.0f, -1.0f}) {
    out->position.push_back(samples.position[nearest]);
    out->normal.push_back(samples.normal[nearest] * side);
    out->albedo.push_back(albedo);
    out->area.push_back(samples.area[nearest] * static_cast<float>(end - begin));
    for (size_t i = begin; i < end; ++i) {
      out->start.push_back(samples.position[i]);
      out->start_normal.push_back(samples.normal[i] * side);
      if (!samples.shading_normal.empty())
        out->start_shading.push_back(samples.shading_normal[i] * side);
    }
    out->first.push_back(out->start.size());
  }
}

/// Of the sums over channels of record_means().
std::vector<float> record_variances(const CacheRecords& records,
                                    const pathtrace::DirectLight& direct) {
  std::vector<float> out(records.position.size());
  for (size_t i = 0; i < out.size(); ++i) {
    const size_t begin = records.first[i], end = records.first[i + 1];
    for (size_t k = begin; k < end; ++k) {
      const Rgb& light = direct.irradiance[k];
      if (!(luminance(light) > 0)) continue;
      const float channels = (light.x + light.y + light.z) / luminance(light);
      out[i] += direct.variance[k] * channels * channels;
    }
    const auto count = static_cast<float>(end - begin);
    out[i] /= count * count;
  }
  return out;
}

}  // namespace

void CacheRecords::add(const Vec3& at, const Vec3& side, const Rgb& color, float stands_for) {
  position.push_back(at);
  normal.push_back(side);
  albedo.push_back(color);
  area.push_back(stands_for);
  start.push_back(at);
  start_normal.push_back(side);
  first.push_back(start.size());
}

CacheRecords sample_records(const pathtrace::Bvh& bvh, int64_t count, uint64_t seed) {
  LTE_CHECK(count >= 1, "a cache needs at least one record, got ", count);
  scene::SamplerOptions options;
  options.seed = seed;
  options.emissive_share = kEmissiveShare;
  options.environment_share = 0;
  options.punctual_lights = false;
  options.shading_normals = true;
  const scene::SurfaceSamples samples =
      scene::sample_surface(bvh.scene(), (count + 1) / 2 * kRecordPoints, options);
  // Points of the same run of kRecordPoints may be joined; each begins a record or goes on with it.
  const auto size = static_cast<int64_t>(samples.position.size());
  std::vector<uint8_t> begins(samples.position.size(), 1);
  parallel_for((size + kRecordPoints - 1) / kRecordPoints, kRuns, [&](int64_t low, int64_t high) {
    for (int64_t run = low; run < high; ++run) {
      auto begin = static_cast<size_t>(run * kRecordPoints);
      const auto end = static_cast<size_t>(std::min((run + 1) * kRecordPoints, size));
      for (size_t i = begin + 1; i < end; ++i) {
        begins[i] =
            !usable(samples, begin) || !usable(samples, i) || !joins(bvh, samples, begin, i);
        if (begins[i]) begin = i;
      }
    }
  });
  CacheRecords out;
  for (size_t begin = 0, end = 0; begin < begins.size(); begin = end) {
    for (end = begin + 1; end < begins.size() && !begins[end];) ++end;
    if (usable(samples, begin)) add_records(samples, begin, end, &out);
  }
  return out;
}

std::vector<Rgb> RecordLight::total() const {
  std::vector<Rgb> sum(direct);
  for (size_t i = 0; i < sum.size(); ++i) sum[i] += indirect[i];
  return sum;
}

std::vector<Rgb> RecordLight::shorter() const {
  if (last.empty()) return {};
  std::vector<Rgb> sum = total();
  for (size_t i = 0; i < sum.size(); ++i) {
    for (int c = 0; c < 3; ++c) sum[i][c] = std::max(0.0f, sum[i][c] - last[i][c]);
  }
  return sum;
}

std::vector<Rgb> record_means(const CacheRecords& records, std::span<const Rgb> of_point) {
  std::vector<Rgb> out(records.position.size());
  for (size_t i = 0; i < out.size(); ++i) {
    const size_t begin = records.first[i], end = records.first[i + 1];
    for (size_t k = begin; k < end; ++k) out[i] += of_point[k];
    out[i] = out[i] / static_cast<float>(end - begin);
  }
  return out;
}

RecordLight estimate_records(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                             const CacheRecords& records, int paths, int max_depth, uint64_t seed) {
  RecordLight out;
  const size_t points = records.start.size();
  const int rays = std::max(1, paths / kRecordPoints);
  // Light that a bumpy surface reflects is less than a level one's: what it hides from itself is
  // lost.
  const std::span<const Vec3> level =
      records.start_shading.empty() ? std::span<const Vec3>() : records.start_normal;
  const std::span<const Vec3> normals =
      level.empty() ? records.start_normal : records.start_shading;
  Gathered found;  // without a cache: by whole paths, side by side as one point has few
  if (max_depth > 1) {
    GatherOptions options;
    options.rays = rays;
    options.max_depth = max_depth;
    options.last = true;
    options.seed = seed;
    found = gather_irradiance(bvh, lights, IrradianceCache(bvh, {}, {}), records.start, normals,
                              options, 0, level);
  }
  std::vector<uint64_t> streams(points);
  std::iota(streams.begin(), streams.end(), uint64_t{0});
  pathtrace::DirectOptions options;
  options.seed = seed;
  options.hemisphere_share = 1;
  options.hemisphere_elsewhere = max_depth > 1;
  options.variance = rays > 1;
  pathtrace::DirectLight direct =
      pathtrace::estimate_direct(bvh, lights, {records.start, normals, streams, level},
                                 std::vector<int32_t>(points, rays), options);
  if (options.variance) out.direct_variance = record_variances(records, direct);
  for (size_t k = 0; k < found.met.size(); ++k) direct.irradiance[k] += found.met[k];
  found.indirect.resize(points);
  out.direct = record_means(records, direct.irradiance);
  out.indirect = record_means(records, found.indirect);
  out.last = max_depth > 1 ? record_means(records, found.last) : out.direct;
  out.rays_traced = found.rays_traced + direct.rays_traced;
  return out;
}

}  // namespace lte::gi
