#include "infer/probe/probe_answers.h"

#include <cmath>
#include <memory>
#include <utility>

#include "infer/probe/expected_error.h"
#include "infer/probe/gathered_probe.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/cli/progress.h"
#include "lte/embed/culled_lights.h"

namespace lte::infer {
namespace {

constexpr int64_t kReferenceRays = 1024;
/// Cap on paths when --error decides how many a point needs and --spp is not given.
constexpr int64_t kDefaultCap = 65536;
// Caches draw other numbers than paths, and so does the check.
constexpr uint64_t kCaches = 62, kCheckPaths = 63;

/// Paths: all light of a reference, else direct light alone.
pathtrace::ProbeResult trace(const ProbeRequest& request, const Renderer& renderer,
                             const scene::PointTable& points) {
  pathtrace::ProbeOptions options;
  options.rays = rays_of(request);
  options.max_depth = request.by_paths() ? request.max_depth : 1;
  options.target_error = request.error;
  options.seed = request.seed;
  const bool to_target = options.target_error > 0;
  Progress progress("tracing", to_target ? 0 : static_cast<int64_t>(points.size()),
                    to_target ? "paths" : "points");
  options.done = [&progress](int64_t count) { progress.advance(count); };
  return pathtrace::probe(renderer.bvh(), renderer.lights(), points, options);
}

/// Embeddings for the two caches, each of scene points and light estimates of its own: what they
/// disagree by is part of the error. One that is read from a file, that alone.
std::vector<render::IrradianceSource> sources_of(const ProbeRequest& request,
                                                 const runtime::Network& network,
                                                 EmbedSettings settings, Renderer* renderer) {
  std::vector<render::IrradianceSource> out;
  provide_embedding(request.embedding, network, settings, renderer);
  out.push_back(renderer->source());
  if (request.embedding.has_file()) return out;
  ++settings.seed;
  renderer->embed(network, settings);
  out.push_back(renderer->source());
  return out;
}

GatheredProbe gather(const ProbeRequest& request,
                     const std::vector<render::IrradianceSource>& sources,
                     const scene::PointTable& points, const Renderer& renderer) {
  GatheredProbeOptions options;
  options.rays = static_cast<int>(rays_of(request));
  options.max_depth = request.max_depth;
  options.seed = request.seed;
  Progress progress("gathering", options.tables * static_cast<int64_t>(points.size()), "points");
  options.done = [&progress](int64_t count) { progress.advance(count); };
  render::CacheSettings cache = cache_settings(request);
  const auto make_cache = [&](int number) {
    const auto at = static_cast<uint64_t>(number);
    cache.seed = hash_combine(hash_combine(request.seed, kCaches), at);
    return render::make_cache(
        {renderer.bvh(), renderer.lights()}, cache,
        sources.empty() ? render::IrradianceSource() : sources[at % sources.size()]);
  };
  return gather_at(renderer.bvh(), renderer.lights(), points, options, make_cache);
}

LightCheck check(const ProbeRequest& request, const scene::PointTable& points,
                 const std::vector<Rgb>& light, const Renderer& renderer) {
  AnsweredLight answered{points.position, points.normal, light};
  CheckOptions options;
  const GatheredProbeOptions gathered;
  const int64_t of_tables =
      gathered.tables * request.records * render::CacheSettings().paths * request.max_depth;
  options.max_paths =
      paths_to_check(static_cast<int64_t>(points.size()) * rays_of(request) + of_tables);
  options.max_depth = request.max_depth;
  options.seed = hash_combine(request.seed, kCheckPaths);
  return check_light(renderer.bvh(), renderer.lights(), answered, options);
}

ProbeAnswer by_paths(const ProbeRequest& request, const scene::PointTable& points,
                     const Renderer& renderer) {
  ProbeAnswer answer;
  answer.light = trace(request, renderer, points);
  for (const Rgb& error : answer.light.standard_error) answer.expected_error.push_back(rms(error));
  return answer;
}

}  // namespace

int64_t rays_of(const ProbeRequest& request) {
  if (request.spp > 0) return request.spp;
  if (request.by_paths()) return request.error > 0 ? kDefaultCap : kReferenceRays;
  return GatheredProbeOptions().rays;
}

std::string who_answers(const ProbeRequest& request) {
  if (request.by_paths()) return "all light by paths";
  return concat("indirect light by ", rays_of(request), " rays a point that read ",
                request.needs_network() ? "the network's" : "path-traced", " light on surfaces");
}

ProbeAnswer answer_points(const ProbeRequest& request, const runtime::Network* network,
                          const EmbedSettings& settings, const scene::PointTable& points,
                          Renderer* renderer) {
  if (request.by_paths()) return by_paths(request, points, *renderer);
  std::vector<render::IrradianceSource> sources;
  if (network != nullptr) sources = sources_of(request, *network, settings, renderer);
  ProbeAnswer answer;
  answer.light = trace(request, *renderer, points);
  answer.culled_lights = embed::names_of(renderer->bvh().scene(), renderer->culled_lights());
  const GatheredProbe found = gather(request, sources, points, *renderer);
  if (request.check) answer.check = check(request, points, found.indirect, *renderer);
  answer.expected_error = expected_errors(found, answer.light.standard_error, answer.check);
  for (size_t i = 0; i < found.indirect.size(); ++i) {
    answer.light.total[i] = answer.light.direct[i] + found.indirect[i];
    answer.light.rays[i] += found.rays;
    Rgb& error = answer.light.standard_error[i];
    for (int c = 0; c < 3; ++c) error[c] = std::hypot(error[c], found.standard_error[i][c]);
  }
  return answer;
}

ProbeAnswer darkness(const scene::PointTable& points) {
  const std::vector<Rgb> black(points.size());
  ProbeAnswer answer;
  answer.light = {black, black, black, std::vector<int64_t>(points.size()), 0};
  answer.expected_error.resize(points.size());
  return answer;
}

}  // namespace lte::infer
