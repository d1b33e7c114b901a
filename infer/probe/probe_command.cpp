#include "infer/probe/probe_command.h"

#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "infer/light/unreached_light.h"
#include "infer/light/untrained_light.h"
#include "infer/probe/neural_probe.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/assets.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/timer.h"
#include "lte/cli/numbers.h"
#include "lte/cli/progress.h"
#include "lte/cli/writable.h"
#include "lte/nn/device.h"
#include "lte/pathtrace/probe.h"
#include "lte/pathtrace/reach/lost_light.h"
#include "lte/scene/light_points.h"

namespace lte::infer {
namespace {

constexpr int64_t kReferenceRays = 1024, kShadowRays = 64;
/// Cap on rays when --target-error decides how many a point needs and --rays is not given.
constexpr int64_t kDefaultCap = 65536;

/// A table in the making, and what there is to say about it.
struct Answer {
  pathtrace::ProbeResult light;
  std::vector<double> expected_error;
  std::vector<ErrorTerms> error_terms;  ///< of the network, if they are asked for
  int64_t off_surface = 0;
  std::vector<std::string> left_out;  ///< names of lights that the network was not told of
};

void check_usage(const ProbeRequest& request) {
  const bool neural = request.mode == "neural";
  if (neural && request.target_error > 0)
    throw CLI::ValidationError("--target-error", "goes with --mode reference only");
  if (!neural && request.embedding.has_file())
    throw CLI::ValidationError("--embedding, --save-embedding", "go with --mode neural only");
  if (!neural && request.error_terms)
    throw CLI::ValidationError("--error-terms", "goes with --mode neural only");
  if (request.validate_only) return;
  if (request.points.empty())
    throw CLI::ValidationError("--points", "name a CSV file with the header px,py,pz,nx,ny,nz");
  if (request.out.empty()) throw CLI::ValidationError("--out", "name the CSV file to write");
}

pathtrace::ProbeOptions tracing_of(const ProbeRequest& request) {
  pathtrace::ProbeOptions options;
  const bool neural = request.mode == "neural";
  options.rays = request.rays.value_or(neural                     ? kShadowRays
                                       : request.target_error > 0 ? kDefaultCap
                                                                  : kReferenceRays);
  options.max_depth = neural ? 1 : request.max_depth;
  options.target_error = request.target_error;
  options.seed = request.seed;
  return options;
}

/// Paths: all light in reference mode, direct light in neural mode.
pathtrace::ProbeResult trace(const ProbeRequest& request, const Renderer& renderer,
                             const scene::PointTable& points) {
  pathtrace::ProbeOptions options = tracing_of(request);
  const bool by_paths = options.target_error > 0;
  Progress progress("tracing", by_paths ? 0 : static_cast<int64_t>(points.size()),
                    by_paths ? "paths" : "points");
  options.done = [&progress](int64_t count) { progress.advance(count); };
  return pathtrace::probe(renderer.bvh(), renderer.lights(), points, options);
}

/// What the network is told of the scene. Warns of light in it that the network does not know.
EmbedSettings told_of(const ProbeRequest& request, const runtime::Network& network,
                      const scene::PointTable& points, const Renderer& renderer) {
  EmbedSettings settings = embed_settings(request.embedding, request.seed,
                                          runtime::MemoryLimit(request.tool.max_memory_mb));
  leave_out_unreached(request.embedding, renderer.bvh(), network,
                      SurfacePlaces{points.position, points.normal}, &settings);
  const std::string note =
      untrained_light_note(renderer.bvh().scene(), network.metadata(), settings.unreached);
  if (!note.empty()) log_warning(note);
  return settings;
}

/// The network's answers by as many embeddings as --draws says; by one that is read from a file,
/// that alone.
Draws ask(const ProbeRequest& request, const runtime::Network& network, EmbedSettings settings,
          const scene::PointTable& points, const std::vector<Rgb>& albedo, Renderer* renderer) {
  const int count = request.embedding.load.empty() ? request.embedding.draws : 1;
  settings.draws = 1;  // one after the other, as their spread tells too
  Draws draws;
  for (int i = 0; i < count; ++i, ++settings.seed) {
    if (i == 0) {
      provide_embedding(request.embedding, network, settings, renderer);
    } else {
      renderer->embed(network, settings);
    }
    draws.add(ask_at(renderer->embedding(), points, albedo));
  }
  return draws;
}

Answer ask_network(const ProbeRequest& request, const runtime::Network& network,
                   const EmbedSettings& settings, const scene::PointTable& points,
                   Renderer* renderer) {
  const PointAlbedo surface = albedo_at(renderer->bvh(), points);
  const Draws draws = ask(request, network, settings, points, surface.albedo, renderer);
  Answer answer{trace(request, *renderer, points),
                {},
                {},
                surface.off_surface,
                names_of(renderer->bvh().scene(), renderer->left_out())};
  const std::vector<Rgb> mean = draws.mean();
  const std::vector<ErrorTerms> terms =
      draws.error_terms(nearness_at(renderer->bvh(), points, latent_spacing(renderer->embedding())),
                        answer.light.direct);
  const ErrorTerms& shares = error_shares(network.config().light_input, draws.count() > 1);
  for (size_t i = 0; i < mean.size(); ++i) {
    Rgb& total = answer.light.total[i];
    double error = expected_error(terms[i], shares);
    if (network.predicts_total()) {
      total = mean[i];
    } else {
      total = answer.light.direct[i] + mean[i];
      error = std::hypot(error, rms(answer.light.standard_error[i]));
    }
    answer.expected_error.push_back(error);
  }
  if (request.error_terms) answer.error_terms = terms;
  return answer;
}

Answer ask_paths(const ProbeRequest& request, const Renderer& renderer,
                 const scene::PointTable& points) {
  Answer answer{trace(request, renderer, points), {}, {}, 0, {}};
  for (const Rgb& error : answer.light.standard_error) answer.expected_error.push_back(rms(error));
  return answer;
}

/// Black: nothing shines, so there is nothing to ask about.
Answer darkness(const ProbeRequest& request, const scene::PointTable& points) {
  const std::vector<Rgb> black(points.size());
  return {{black, black, black, std::vector<int64_t>(points.size()), 0},
          std::vector<double>(points.size()),
          std::vector<ErrorTerms>(request.error_terms ? points.size() : 0),
          0,
          {}};
}

scene::PointColumns columns_of(const Answer& answer) {
  scene::PointColumns columns = probe_columns(answer.light);
  columns.names.push_back("expected_error");
  for (size_t i = 0; i < columns.rows.size(); ++i)
    columns.rows[i].push_back(answer.expected_error[i]);
  if (answer.error_terms.empty()) return columns;
  columns.names.insert(columns.names.end(), ErrorTerms::kNames.begin(), ErrorTerms::kNames.end());
  for (size_t i = 0; i < columns.rows.size(); ++i) {
    const auto values = answer.error_terms[i].values();
    columns.rows[i].insert(columns.rows[i].end(), values.begin(), values.end());
  }
  return columns;
}

void say(const ProbeRequest& request, const Answer& answer, size_t points) {
  if (answer.light.missed > 0)
    log_warning(answer.light.missed, " of ", points, " points are above --target-error ",
                request.target_error, "; raise --rays above ", tracing_of(request).rays);
  if (answer.off_surface > 0)
    log_warning(request.points, ": ", answer.off_surface, " of ", points,
                " points lie on no surface; the network was trained on surfaces alone, so expect "
                "more error there");
}

void write(const ProbeRequest& request, const scene::PointTable& points, const Answer& answer,
           double seconds) {
  scene::write_point_table(request.out, points, columns_of(answer));
  log_info(request.out, ": ", points.size(), " points in ", seconds, " s");
  if (request.tool.common.json.empty()) return;
  const nlohmann::json json = {{"scene", request.scene},
                               {"mode", request.mode},
                               {"points", points.size()},
                               {"off_surface", answer.off_surface},
                               {"above_target", answer.light.missed},
                               {"left_out_lights", answer.left_out},
                               {"seconds", seconds}};
  write_file(request.tool.common.json, json.dump(2) + "\n");
}

void claim_files(const ProbeRequest& request, CommandFiles* files) {
  claim_scene(request, files);
  claim_embedding(request.embedding, files);
  files->reads("--points", request.points);
  files->reads("--checkpoint", request.checkpoint);
  files->writes("--out", request.out);
  files->writes_common(request.tool.common);
  files->check();
}

std::optional<runtime::Network> load_network(const ProbeRequest& request, const scene::Scene& scene,
                                             bool has_light) {
  if (request.mode != "neural" || !has_light) return std::nullopt;
  const c10::Device device = nn::choose_device(request.tool.device, 0, "--device");
  runtime::Network network(checkpoint_or_shipped(request.checkpoint),
                           {device, choose_precision(request.tool.precision, device)});
  network.check_fits(max_component(scene::point_bounds(scene).extent()), request.embedding.rescale);
  return network;
}

}  // namespace

void add_probe_options(CLI::App& app, ProbeRequest* r) {
  app.add_option("scene", r->scene, "Scene: .gltf, .glb, .pbrt, .obj or .ply")->required();
  app.add_option("--points", r->points,
                 "CSV file with the header px,py,pz,nx,ny,nz, world space, on surfaces");
  app.add_option("--out", r->out, "CSV file to write");
  app.add_option("--mode", r->mode, "The network, or the path-traced reference")
      ->check(CLI::IsMember({"neural", "reference"}))
      ->capture_default_str();
  app.add_option("--checkpoint", r->checkpoint, "Model; by default the shipped one");
  app.add_option("--rays", r->rays,
                 "Reference mode: paths a point, 1024, or with --target-error their cap, 65536; "
                 "neural mode: rays a point for direct light, 64")
      ->check(CLI::Range(int64_t{1}, int64_t{1} << 30));
  app.add_option("--max-depth", r->max_depth, "Reference mode: surface hits of a path")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--target-error", r->target_error,
                 "Reference mode: relative standard error of total irradiance to reach, e.g. 0.01; "
                 "0: fixed --rays")
      ->check(non_negative_number());
  app.add_flag("--error-terms", r->error_terms,
               "Neural mode: also write the terms that the expected error is made of");
  add_embedding_flags(app, &r->embedding, /*draws=*/2);
  app.add_option("--seed", r->seed, "Seed of scene points and paths")->capture_default_str();
  app.add_flag("--validate-only", r->validate_only, "Check scene, points and flags, and stop");
  add_scene_options(app, r);
  add_tool_options(app, &r->tool);
}

void run_probe(const ProbeRequest& request) {
  check_usage(request);
  CommandFiles files;
  claim_files(request, &files);
  apply_tool_options(request.tool);
  for (const std::string& path : {request.out, request.tool.common.json, request.embedding.save})
    check_writable(path);
  const Timer timer;
  scene::PointTable points;
  if (!request.points.empty()) points = scene::read_point_table(request.points);
  const scene::Scene scene = load_source(request);
  describe(scene, request.scene);
  Renderer renderer(scene);
  if (!renderer.has_light())
    log_warning(request.scene,
                ": nothing emits light (--environment 1,1,1 or --add-light auto gives it some)");
  pathtrace::warn_of_lost_light(request.scene, renderer.bvh());
  const std::optional<runtime::Network> network =
      load_network(request, scene, renderer.has_light());
  files.check_what_was_read();
  EmbedSettings settings;
  if (network) settings = told_of(request, *network, points, renderer);
  if (request.validate_only) {
    std::printf("%s: valid scene, %lld triangles, %zu light groups\n", request.scene.c_str(),
                static_cast<long long>(scene.triangle_count()), scene.light_groups.size());
    return;
  }
  const Answer answer = !renderer.has_light() ? darkness(request, points)
                        : network ? ask_network(request, *network, settings, points, &renderer)
                                  : ask_paths(request, renderer, points);
  say(request, answer, points.size());
  write(request, points, answer, timer.seconds());
}

}  // namespace lte::infer
