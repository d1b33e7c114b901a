#include "bench/bake_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>

#include <nlohmann/json.hpp>

#include "bench/begin_command.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/tool_options.h"
#include "lte/bake/bake.h"
#include "lte/base/file.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/cli/assets.h"
#include "lte/cli/numbers.h"

namespace lte::bench {
namespace {

using namespace infer;

/// Of the mean of all texels: what is darker counts as dark.
constexpr double kDarkShare = 0.01;

struct Row {
  std::string name;
  double seconds = 0, rel_mse = 0, bias = 0, median = 0, p95 = 0, leak = 0;
  double seam = NAN;  ///< where seams are joined
};

/// A scene laid out, and the truth at some of its texels.
struct Measured {
  const scene::Scene& scene;
  Renderer renderer;
  bake::Layout layout;
  bake::TexelLight sides;  ///< of all texels, by a draft
  std::vector<Vec3> normals;
  std::vector<uint32_t> which;
  std::vector<Rgb> truth;
  double layout_seconds = 0;

  explicit Measured(const scene::Scene& of) : scene(of), renderer(of) {}
  render::TracedScene traced() const { return {renderer.bvh(), renderer.lights()}; }
};

Row measure(const Measured& m, const std::string& name, double seconds,
            const std::function<Rgb(size_t k)>& answer) {
  double mean = 0;
  for (const Rgb& value : m.truth) mean += double{luminance(value)};
  mean /= static_cast<double>(m.truth.size());
  Row row{name, seconds};
  std::vector<double> errors;
  double sum = 0, light = 0;
  int64_t dark = 0;
  for (size_t k = 0; k < m.truth.size(); ++k) {
    const double want = double{luminance(m.truth[k])}, got = double{luminance(answer(k))};
    if (want < kDarkShare * mean) {
      row.leak += got / mean;
      ++dark;
      continue;
    }
    row.rel_mse += (got - want) * (got - want) / (want * want + 0.01 * mean * mean);
    errors.push_back(std::abs(got - want) / want);
    sum += got;
    light += want;
  }
  row.leak /= static_cast<double>(std::max<int64_t>(1, dark));
  if (errors.empty()) return row;
  row.rel_mse /= static_cast<double>(errors.size());
  row.bias = sum / light - 1;
  std::sort(errors.begin(), errors.end());
  row.median = errors[errors.size() / 2];
  row.p95 = errors[errors.size() * 95 / 100];
  return row;
}

Row product(Measured* m, const std::string& name, int passes, int path_passes, uint64_t seed) {
  const Timer timer;
  render::CacheSettings cache;
  cache.records = bake::kRecords;
  cache.seed = seed;
  const auto integrator = render::make_gather(m->traced(), cache);
  integrator->prepare();
  bake::LightOptions options;
  options.passes = passes;
  options.path_passes = path_passes;
  options.seed = seed;
  // Where both sides are lit, chance says which is brighter.
  const bake::Sides sides{m->sides.back, 0};
  options.sides = &sides;
  std::vector<bake::BakedLayer> layers;
  layers.push_back({"light", bake::light_texels(m->traced(), *integrator, m->layout.atlas,
                                                m->layout.texels, options)});
  double seam = 0;
  const bake::Lightmap map =
      bake::make_lightmap(m->renderer.bvh(), m->layout, std::move(layers), {}, &seam);
  const double seconds = timer.seconds() + m->layout_seconds;
  const std::vector<float>& light = map.layers[0].irradiance;
  Row row = measure(*m, name, seconds, [&](size_t k) {
    const size_t at = 3 * size_t{m->layout.texels.pixel[m->which[k]]};
    // What fills a texel behind a wall is its neighbours' light and no answer of its own.
    if (map.mask[at / 3] == static_cast<uint8_t>(bake::Texel::Filled)) return m->truth[k];
    return Rgb{light[at], light[at + 1], light[at + 2]};
  });
  row.seam = seam;
  return row;
}

/// Plain paths at every texel; rows without smoothing and with means over neighbours.
void add_paths(const Measured& m, int paths, int rounds, uint64_t seed, std::vector<Row>* rows) {
  const Timer timer;
  bake::LightOptions options;
  options.rays = 4;
  options.passes = std::max(1, paths / options.rays);
  options.seed = seed;
  std::vector<uint32_t> all(m.layout.texels.size());
  std::iota(all.begin(), all.end(), 0u);
  std::vector<Rgb> light =
      bake::trace_texels(m.traced(), m.layout.atlas, m.layout.texels, m.sides.back, all, options);
  const auto at = [&](size_t k) { return light[m.which[k]]; };
  rows->push_back(measure(m, concat("paths ", paths), timer.seconds() + m.layout_seconds, at));
  if (rounds == 0) return;
  const std::vector<uint8_t> none(light.size());
  const bake::TexelGraph graph(m.renderer.bvh(),
                               {m.layout.texels.position, m.normals, m.layout.texels.edge, none});
  light = graph.spread(std::move(light), rounds);
  rows->push_back(
      measure(m, concat("paths ", paths, " smoothed"), timer.seconds() + m.layout_seconds, at));
}

void add_network(Measured* m, const BakeTableRequest& request, std::vector<Row>* rows) {
  const Timer timer;
  const runtime::Network network(checkpoint_or_shipped(request.checkpoint));
  EmbedSettings settings;
  settings.rescale = true;
  settings.seed = request.seed;
  m->renderer.embed(network, settings);
  const std::vector<Rgb> albedo(m->normals.size(), Rgb{0.5f, 0.5f, 0.5f});
  const std::vector<Rgb> light =
      m->renderer.source()(m->layout.texels.position, m->normals, albedo);
  rows->push_back(measure(*m, "network", timer.seconds() + m->layout_seconds,
                          [&](size_t k) { return light[m->which[k]]; }));
}

void prepare(const BakeTableRequest& request, Measured* m) {
  const Timer timer;
  bake::AtlasOptions atlas;
  atlas.size = request.size;
  m->layout = bake::make_layout(m->scene, atlas);
  m->layout_seconds = timer.seconds();
  const bake::Texels& texels = m->layout.texels;
  const auto gather = render::make_gather(m->traced(), {});
  gather->prepare();
  bake::LightOptions draft;
  draft.passes = 2;
  m->sides = bake::light_texels(m->traced(), *gather, m->layout.atlas, texels, draft);
  m->normals = bake::turned_normals(texels, m->sides.back);
  const size_t step = std::max<size_t>(1, texels.size() / static_cast<size_t>(request.measured));
  Rng rng(request.seed, 91);
  for (size_t i = rng.below(step); i < texels.size(); i += step)
    m->which.push_back(static_cast<uint32_t>(i));
  bake::LightOptions reference;
  reference.rays = 16;
  reference.passes = std::max(1, request.reference_paths / reference.rays);
  reference.seed = hash_combine(request.seed, 92);
  m->truth =
      bake::trace_texels(m->traced(), m->layout.atlas, texels, m->sides.back, m->which, reference);
}

}  // namespace

void add_bake_table_options(CLI::App& command, BakeTableRequest* request) {
  command.add_option("SCENE", request->scenes, "Scene files")->required();
  command.add_option("--size", request->size, "Edge of the atlas")
      ->check(CLI::Range(16, bake::kMaxAtlas))
      ->capture_default_str();
  command.add_option("--measured", request->measured, "Texels that the reference knows")
      ->check(positive_number())
      ->capture_default_str();
  command.add_option("--reference-paths", request->reference_paths, "Paths of each of those")
      ->check(positive_number())
      ->capture_default_str();
  command.add_option("--checkpoint", request->checkpoint, "Model; by default the shipped one");
  command.add_option("--seed", request->seed, "Seed of all samples")->capture_default_str();
  add_scene_flags(command, &request->loading);
}

void run_bake_table(const BakeTableRequest& request, const CommonOptions& common) {
  CommandFiles files;
  for (const std::string& scene : request.scenes) files.reads("SCENE", scene);
  begin_command(common, &files, "");
  nlohmann::json json = {{"schema_version", 1}, {"scenes", nlohmann::json::array()}};
  for (const std::string& file : request.scenes) {
    const scene::Scene scene = load_scene(file, request.loading);
    Measured m(scene);
    prepare(request, &m);
    std::vector<Row> rows;
    rows.push_back(product(&m, "bake draft", 2, 0, request.seed));
    rows.push_back(product(&m, "bake preview", 4, 0, request.seed));
    rows.push_back(product(&m, "bake final", 16, 16, request.seed));
    add_network(&m, request, &rows);
    add_paths(m, 16, 2, request.seed, &rows);
    add_paths(m, 64, 1, request.seed, &rows);
    std::printf("%s: %zu texels, layout %.2f s\n%-20s %8s %8s %7s %7s %7s %7s %7s\n", file.c_str(),
                m.layout.texels.size(), m.layout_seconds, "", "seconds", "relMSE", "bias", "median",
                "p95", "leak", "seam");
    for (const Row& row : rows) {
      std::printf("%-20s %8.2f %8.4f %6.1f%% %6.1f%% %6.1f%% %7.4f %6.2f%%\n", row.name.c_str(),
                  row.seconds, row.rel_mse, 100 * row.bias, 100 * row.median, 100 * row.p95,
                  row.leak, 100 * row.seam);
      json["scenes"].push_back({{"scene", file},
                                {"method", row.name},
                                {"texels", m.layout.texels.size()},
                                {"seconds", row.seconds},
                                {"rel_mse", row.rel_mse},
                                {"bias", row.bias},
                                {"median", row.median},
                                {"p95", row.p95},
                                {"leak", row.leak},
                                {"seam", row.seam}});
    }
    std::fflush(stdout);
  }
  if (!common.json.empty()) write_file(common.json, json.dump(2) + "\n");
}

}  // namespace lte::bench
