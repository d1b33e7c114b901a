#include "infer/probe/probe_answers.h"

#include <cmath>
#include <memory>
#include <utility>

#include "infer/light/light_table.h"
#include "infer/light/unreached_light.h"
#include "infer/probe/expected_error.h"
#include "infer/probe/gathered_probe.h"
#include "infer/probe/point_albedo.h"
#include "lte/base/check.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/cli/progress.h"

namespace lte::infer {
namespace {

constexpr int64_t kReferenceRays = 1024, kShadowRays = 64;
/// Cap on rays when --target-error decides how many a point needs and --rays is not given.
constexpr int64_t kDefaultCap = 65536;
// Tables draw other numbers than paths, and so does the check.
constexpr uint64_t kTables = 62, kCheckPaths = 63;

/// Paths: all light of a reference, else direct light alone.
pathtrace::ProbeResult trace(const ProbeRequest& request, const Renderer& renderer,
                             const scene::PointTable& points) {
  pathtrace::ProbeOptions options;
  options.rays = rays_of(request);
  options.max_depth = request.by_paths() ? request.max_depth : 1;
  options.target_error = request.target_error;
  options.seed = request.seed;
  const bool to_target = options.target_error > 0;
  Progress progress("tracing", to_target ? 0 : static_cast<int64_t>(points.size()),
                    to_target ? "paths" : "points");
  options.done = [&progress](int64_t count) { progress.advance(count); };
  return pathtrace::probe(renderer.bvh(), renderer.lights(), points, options);
}

/// As many embeddings as --draws says, each of scene points and light estimates of its own; one
/// that is read from a file, that alone.
std::vector<EmbeddingDraws> draws_of(const ProbeRequest& request, const runtime::Network& network,
                                     EmbedSettings settings, Renderer* renderer) {
  const int count = request.embedding.load.empty() ? request.embedding.draws : 1;
  settings.draws = 1;  // one after the other, as tables read one each
  std::vector<EmbeddingDraws> out(static_cast<size_t>(count));
  for (EmbeddingDraws& draw : out) {
    if (&draw == &out.front()) {
      provide_embedding(request.embedding, network, settings, renderer);
    } else {
      renderer->embed(network, settings);
    }
    draw.add(renderer->shared_embedding());
    ++settings.seed;
  }
  return out;
}

/// The network's own answers: the mean over its embeddings.
void decode(const std::vector<EmbeddingDraws>& draws, const scene::PointTable& points,
            const Renderer& renderer, ProbeAnswer* answer, std::vector<Rgb>* indirect) {
  const PointAlbedo surface = albedo_at(renderer.bvh(), points);
  answer->off_surface = surface.off_surface;
  EmbeddingDraws all;
  for (const EmbeddingDraws& draw : draws) all.add(draw.first());
  *indirect = all.decode({points.position, points.normal, surface.albedo});
}

GatheredProbe gather(const ProbeRequest& request, const std::vector<EmbeddingDraws>& draws,
                     const scene::PointTable& points, const Renderer& renderer) {
  GatheredProbeOptions options;
  options.rays = static_cast<int>(rays_of(request));
  options.max_depth = request.max_depth;
  options.seed = request.seed;
  Progress progress("gathering", options.tables * static_cast<int64_t>(points.size()), "points");
  options.done = [&progress](int64_t count) { progress.advance(count); };
  TableSettings table;
  table.light = draws.empty() ? TableLight::Raw : TableLight::Network;
  table.max_depth = request.max_depth;
  const auto make_table = [&](int number) {
    const auto at = static_cast<uint64_t>(number);
    table.seed = hash_combine(hash_combine(request.seed, kTables), at);
    return make_light_table(renderer.bvh(), renderer.lights(),
                            draws.empty() ? EmbeddingDraws() : draws[at % draws.size()], table);
  };
  return gather_at(renderer.bvh(), renderer.lights(), points, options, make_table);
}

LightCheck check(const ProbeRequest& request, const scene::PointTable& points,
                 const std::vector<Rgb>& light, double seconds, const Renderer& renderer) {
  AnsweredLight answered{points.position, points.normal, light};
  CheckOptions options;
  options.seconds = kCheckShare * seconds;
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
  if (request.rays) return *request.rays;
  if (request.by_paths()) return request.target_error > 0 ? kDefaultCap : kReferenceRays;
  return request.indirect == "decoded" ? kShadowRays : GatheredProbeOptions().rays;
}

std::string who_answers(const ProbeRequest& request) {
  if (request.by_paths()) return "all light by paths";
  if (request.indirect == "decoded")
    return "indirect light by the network at the points themselves";
  return concat("indirect light by ", rays_of(request), " rays a point that read ",
                request.indirect == "network" ? "the network's" : "path-traced",
                " light on surfaces");
}

ProbeAnswer answer_points(const ProbeRequest& request, const runtime::Network* network,
                          const EmbedSettings& settings, const scene::PointTable& points,
                          Renderer* renderer) {
  if (request.by_paths()) return by_paths(request, points, *renderer);
  const Timer timer;
  std::vector<EmbeddingDraws> draws;
  if (network != nullptr) draws = draws_of(request, *network, settings, renderer);
  ProbeAnswer answer;
  answer.light = trace(request, *renderer, points);
  answer.left_out = names_of(renderer->bvh().scene(), renderer->left_out());
  const bool decoded = request.indirect == "decoded";
  GatheredProbe found;
  if (decoded) {
    decode(draws, points, *renderer, &answer, &found.indirect);
  } else {
    found = gather(request, draws, points, *renderer);
  }
  if (request.check == "on")
    answer.check = check(request, points, found.indirect, timer.seconds(), *renderer);
  if (!decoded) {
    answer.expected_error =
        expected_errors(found, answer.light.standard_error, answer.check,
                        network != nullptr ? kUnseenShareOfNetwork : kUnseenShare);
  }
  for (size_t i = 0; i < found.indirect.size(); ++i) {
    answer.light.total[i] = answer.light.direct[i] + found.indirect[i];
    if (decoded) continue;
    answer.light.rays[i] += found.rays;
    Rgb& error = answer.light.standard_error[i];
    for (int c = 0; c < 3; ++c) error[c] = std::hypot(error[c], found.standard_error[i][c]);
  }
  return answer;
}

ProbeAnswer darkness(const ProbeRequest& request, const scene::PointTable& points) {
  const std::vector<Rgb> black(points.size());
  ProbeAnswer answer;
  answer.light = {black, black, black, std::vector<int64_t>(points.size()), 0};
  if (request.indirect != "decoded" || request.by_paths())
    answer.expected_error.resize(points.size());
  return answer;
}

}  // namespace lte::infer
