#include "infer/probe/embedded_light.h"

#include <cmath>
#include <utility>

#include "infer/check/light_check.h"
#include "infer/probe/expected_error.h"
#include "infer/probe/gathered_probe.h"
#include "lte/base/random.h"
#include "lte/pathtrace/probe.h"
#include "lte/pathtrace/reach/reach.h"

namespace lte::infer {
namespace {

constexpr uint64_t kEmbeddedCheck = 64;

/// Depth 1 alone.
pathtrace::ProbeResult direct_light(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                                    const scene::PointTable& points, uint64_t seed) {
  pathtrace::ProbeOptions options;
  options.rays = GatheredProbeOptions().rays;
  options.max_depth = 1;
  options.seed = seed;
  return pathtrace::probe(bvh, lights, points, options);
}

/// Two answers as the shares of a probe: their difference tells the standard error of one.
GatheredProbe as_probe(std::vector<Rgb> one, const std::vector<Rgb>& other) {
  GatheredProbe out;
  out.tables = 2;
  out.standard_error.reserve(one.size());
  for (size_t i = 0; i < one.size(); ++i) {
    const Rgb apart = (one[i] - other[i]) / std::sqrt(2.0f);
    out.standard_error.push_back({std::abs(apart.x), std::abs(apart.y), std::abs(apart.z)});
  }
  out.indirect = std::move(one);
  return out;
}

}  // namespace

EmbeddedLight embedded_light(const runtime::SceneEmbedding& embedding,
                             const scene::PointTable& points, std::span<const Rgb> albedo,
                             const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                             const EmbeddedLightOptions& options) {
  const runtime::QueryPoints queries{points.position, points.normal, albedo};
  EmbeddedLight out{embedding.decode(queries), {}};
  std::vector<Rgb> direct(points.size()), direct_error(points.size());
  if (options.direct && !points.position.empty()) {
    pathtrace::ProbeResult traced = direct_light(bvh, lights, points, options.seed);
    direct = std::move(traced.direct);
    direct_error = std::move(traced.standard_error);
  }
  if (options.other != nullptr) {
    CheckOptions checking;
    checking.seed = hash_combine(options.seed, kEmbeddedCheck);
    const LightCheck checked =
        check_light(bvh, lights, {points.position, points.normal, out.irradiance}, checking);
    out.expected_error = expected_errors(as_probe(out.irradiance, options.other->decode(queries)),
                                         direct_error, checked);
    // What a network says of the inside of a cupboard is an error, and paths that meet no light
    // there cannot say how large, relative to it.
    const std::vector<uint8_t> lit =
        pathtrace::reached(bvh, points.position, points.normal, pathtrace::Sides::Front, {});
    for (size_t i = 0; i < lit.size(); ++i)
      if (lit[i] == 0) out.expected_error[i] = rms(out.irradiance[i]);
  }
  for (size_t i = 0; i < direct.size(); ++i) out.irradiance[i] += direct[i];
  return out;
}

}  // namespace lte::infer
