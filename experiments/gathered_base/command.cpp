// Irradiance at points by rays that read light on surfaces: what each table of light and number of
// rays is worth, beside the network asked at the points.
#include "experiments/command.h"

#include <cstdio>
#include <functional>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "bench/begin_command.h"
#include "experiments/gathered_base/measure.h"
#include "infer/renderer/renderer.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/cli/assets.h"
#include "lte/cli/cli.h"
#include "lte/cli/scene_source.h"
#include "lte/embed/embed.h"

namespace lte::experiments {

using namespace infer;

namespace {

struct Request : SceneSource {
  std::string checkpoint, references;  ///< empty: as the help says
  QueryOptions queries;
  TableOptions tables;
  MeasureOptions measure;
  uint64_t seed = 0;
  CommonOptions common;
};

nlohmann::json json_of(const Request& request, const LightTables& maker, const Measured& measured) {
  nlohmann::json json = {{"scene", request.scene},
                         {"mean", measured.mean},
                         {"records", maker.size()},
                         {"direct_seconds", maker.direct_seconds()},
                         {"answers", nlohmann::json::array()},
                         {"tables", nlohmann::json::array()}};
  for (const AnswerRow& row : measured.answers) {
    json["answers"].push_back({{"name", row.name},
                               {"rays", row.rays},
                               {"mse", row.mse},
                               {"worth", row.worth},
                               {"mean_ratio", row.mean_ratio},
                               {"microseconds", row.microseconds}});
  }
  for (const TableRow& row : measured.tables)
    json["tables"].push_back({{"name", row.name}, {"seconds", row.seconds}, {"bias", row.bias}});
  return json;
}

void print(const Measured& measured) {
  std::printf("%-18s %5s %10s %10s %8s\n", "answers", "rays", "worth", "mean ratio", "us");
  for (const AnswerRow& row : measured.answers)
    std::printf("%-18s %5d %10.1f %10.3f %8.2f\n", row.name.c_str(), row.rays, row.worth,
                row.mean_ratio, row.microseconds);
}

void add_options(CLI::App& app, Request* r) {
  app.add_option("SCENE", r->scene, "Scene file")->required();
  add_scene_options(app, r);
  app.add_option("--checkpoint", r->checkpoint, "Model that solves light; by default lte");
  app.add_option("--points", r->queries.points, "Points over the surfaces that light reaches")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_option("--paths", r->queries.paths, "Paths a point of each of both references")
      ->check(CLI::Range(2, 1 << 20))
      ->capture_default_str();
  app.add_option("--references", r->references,
                 "File of the references: read if it is there, else written");
  app.add_option("--records", r->tables.records, "Places that a table of light knows")
      ->check(CLI::Range(2, 1 << 20))
      ->capture_default_str();
  app.add_option("--direct", r->tables.direct_paths, "Paths of direct light at each of them")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_option("--truth", r->tables.reference_paths,
                 "Paths a record of a table of path-traced light without much noise; 0: none")
      ->check(CLI::Range(0, 1 << 20))
      ->capture_default_str();
  app.add_option("--rays", r->measure.rays, "Numbers of rays a point, the most last")
      ->delimiter(',')
      ->check(CLI::Range(1, 1 << 16))
      ->capture_default_str();
  app.add_option("--seed", r->seed, "Of everything")->capture_default_str();
  add_common_options(app, &r->common);
}

void run(Request request) {
  request.queries.seed = request.tables.seed = request.measure.seed = request.seed;
  CommandFiles files;
  claim_scene(request, &files);
  files.reads("--checkpoint", request.checkpoint);
  files.writes("--references", request.references);
  bench::begin_command(request.common, &files);
  const scene::Scene scene = load_source(request);
  Renderer renderer(scene);
  LTE_CHECK(renderer.has_light(), scene.name, ": nothing emits light");
  const runtime::Network network(checkpoint_or_shipped(request.checkpoint));
  LTE_CHECK(network.config().solves_light(), "--checkpoint: the model solves no light");
  const render::TracedScene traced{renderer.bvh(), renderer.lights()};
  const Queries queries = make_queries(traced, request.queries, request.references);
  embed::EmbedSettings embedding;
  embedding.rescale = true;
  embedding.seed = request.seed;
  embedding.culled_lights = embed::culled_lights(
      renderer.bvh(), network, embedding, embed::SurfacePlaces{queries.position, queries.normal});
  renderer.embed(network, embedding);
  const LightTables maker(traced, request.tables);
  const Measured measured = measure(traced, maker, maker.make(renderer.embedding()),
                                    renderer.embedding(), queries, request.measure);
  print(measured);
  if (!request.common.json.empty())
    write_file(request.common.json, json_of(request, maker, measured).dump(2) + '\n');
}

}  // namespace

std::function<void()> add_command(CLI::App* app) {
  const auto request = std::make_shared<Request>();
  app->name("experiment_gathered_base");
  app->description("What rays that read light on surfaces are worth at points.");
  add_options(*app, request.get());
  return [request] { run(*request); };
}

}  // namespace lte::experiments
