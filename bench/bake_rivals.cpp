#include "bench/bake_rivals.h"

#include <filesystem>
#include <numeric>

#include <nlohmann/json.hpp>

#include "infer/tool/tool_options.h"
#include "lte/bake/lightmap.h"
#include "lte/base/check.h"
#include "lte/base/child_process.h"
#include "lte/base/file.h"
#include "lte/base/parallel.h"
#include "lte/base/scratch_folder.h"
#include "lte/cli/assets.h"
#include "lte/image/denoise.h"
#include "lte/image/exr.h"

namespace lte::bench {
namespace {

constexpr const char* kCyclesScript = "scripts/validation/cycles_light_map.py";

/// Texels' light in the atlas, with the space between charts filled; what is dark stays 0.
std::vector<float> picture_of(const MeasuredScene& m, const std::vector<Rgb>& light) {
  return bake::paint(m.layout.atlas, m.layout.texels, light, m.mask);
}

}  // namespace

void add_paths(const MeasuredScene& m, int paths, int rounds, uint64_t seed,
               std::vector<BakeRow>* rows) {
  const Stopwatch watch;
  bake::LightOptions options;
  options.rays = 4;
  options.passes = std::max(1, paths / options.rays);
  options.seed = seed;
  std::vector<uint32_t> all(m.layout.texels.size());
  std::iota(all.begin(), all.end(), 0u);
  const std::vector<Rgb> light =
      bake::trace_texels(m.traced(), m.layout.atlas, m.layout.texels, m.sides.back, all, options);
  const Seconds traced = watch.seconds();
  rows->push_back(
      measure(m, concat("paths ", paths), traced, [&](size_t k) { return light[m.which[k]]; }));

  const Stopwatch smoothing;
  const std::vector<uint8_t> none(light.size());
  const bake::TexelGraph graph(m.renderer.bvh(),
                               {m.layout.texels.position, m.normals, m.layout.texels.edge, none});
  const std::vector<Rgb> smooth = graph.spread(light, rounds);
  rows->push_back(measure(m, concat("paths ", paths, ", smoothed"), traced + smoothing.seconds(),
                          [&](size_t k) { return smooth[m.which[k]]; }));

  const std::optional<image::Oidn> oidn = image::Oidn::find();
  if (!oidn) return;
  const Stopwatch denoising;
  image::Image picture(m.layout.atlas.width, m.layout.atlas.height, 3);
  picture.pixels = picture_of(m, light);
  const image::Image clean = oidn->denoise(picture, {});
  rows->push_back(measure_picture(m, concat("paths ", paths, ", OIDN"),
                                  traced + denoising.seconds(), clean.pixels, m.mask));
}

void add_network(const std::string& checkpoint, uint64_t seed, MeasuredScene* m,
                 std::vector<BakeRow>* rows) {
  const Stopwatch watch;
  const runtime::Network network(checkpoint_or_shipped(checkpoint));
  infer::EmbedSettings settings;
  settings.rescale = true;
  settings.seed = seed;
  m->renderer.embed(network, settings);
  const std::vector<Rgb> albedo(m->normals.size(), Rgb{0.5f, 0.5f, 0.5f});
  const std::vector<Rgb> light =
      m->renderer.source()(m->layout.texels.position, m->normals, albedo);
  rows->push_back(
      measure(*m, "network", watch.seconds(), [&](size_t k) { return light[m->which[k]]; }));
}

void add_cycles(const MeasuredScene& m, const std::string& python, int samples, uint64_t seed,
                std::vector<BakeRow>* rows) {
  const ScratchFolder folder;
  const std::filesystem::path glb = folder.path() / "scene.glb", exr = folder.path() / "cycles.exr",
                              json = folder.path() / "cycles.json";
  bake::Lightmap map;
  map.width = m.layout.atlas.width;
  map.height = m.layout.atlas.height;
  map.scene = m.layout.atlas.scene;
  map.placements = m.layout.atlas.placements;
  map.mask = m.mask;
  map.layers.push_back({"light", std::vector<float>(3 * map.pixels(), 1)});
  bake::write_lightmap_glb(glb, map);
  ChildProcess cycles({python, kCyclesScript, glb.string(), "--out", exr.string(), "--json",
                       json.string(), "--size", concat(map.width, "x", map.height), "--samples",
                       std::to_string(samples), "--seed", std::to_string(seed), "--threads",
                       std::to_string(num_threads())});
  const int status = cycles.wait();
  LTE_CHECK(status == 0, "--cycles: ", python, " ", kCyclesScript, " ended with ", status);
  const nlohmann::json told = nlohmann::json::parse(read_file(json));
  const image::Image light = image::read_exr(exr);
  LTE_CHECK(light.width == map.width && light.height == map.height, exr.string(),
            ": is not of the atlas's size");
  // What it has of charts whose back is lit is no answer, and counts as little as a filled texel.
  std::vector<uint8_t> mask = m.mask;
  for (size_t i = 0; i < m.layout.texels.size(); ++i)
    if (m.sides.back[static_cast<size_t>(m.layout.texels.chart[i])] != 0)
      mask[m.layout.texels.pixel[i]] = static_cast<uint8_t>(bake::Texel::Filled);
  rows->push_back(measure_picture(m, concat("Cycles ", samples),
                                  {told.at("seconds"), told.at("processor_seconds")}, light.pixels,
                                  mask));
}

}  // namespace lte::bench
