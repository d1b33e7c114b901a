#include "infer/render/incident_map.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <vector>

#include <nlohmann/json.hpp>

#include "infer/render/frame_io.h"
#include "infer/render/scene_size.h"
#include "infer/tool/assets.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/text.h"
#include "lte/cli/command_files.h"
#include "lte/cli/writable.h"
#include "lte/image/exr.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "lte/pathtrace/incident/incident.h"
#include "lte/scene/closest_point.h"

namespace lte::infer {
namespace {

using image::Image;

constexpr int kBins = 32;
constexpr int kZoom = 8;  ///< pixels of a .png for a cell

/// By paths, of light that bounced at least once.
std::vector<Rgb> traced_map(const Renderer& renderer, const scene::Surface& at,
                            const RenderRequest& request) {
  pathtrace::IncidentOptions options;
  options.bins = kBins;
  options.samples = request.spp;
  options.max_depth = request.max_depth;
  options.seed = request.seed;
  const pathtrace::IncidentRadiance traced = pathtrace::estimate_incident(
      renderer.bvh(), renderer.lights(), {&at.position, 1}, {&at.normal, 1}, options);
  std::vector<Rgb> out(static_cast<size_t>(traced.cells()));
  for (size_t i = 0; i < traced.indirect.size(); ++i) out[i % out.size()] += traced.indirect[i];
  return out;
}

/// ((log(x + 1) − log(y + 1)) / (log(y + 1) + 0.1))², x and y π times radiance over the emission,
/// as lte_eval incident has it.
double log_relative_error(std::span<const Rgb> got, std::span<const Rgb> wanted, double emission) {
  constexpr double kEpsilon = 0.1;
  double sum = 0;
  for (size_t i = 0; i < got.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double x = std::log1p(double{kPi} * got[i][c] / emission),
                   y = std::log1p(double{kPi} * wanted[i][c] / emission);
      sum += (x - y) * (x - y) / ((y + kEpsilon) * (y + kEpsilon));
    }
  }
  return sum / (3 * static_cast<double>(got.size()));
}

Image zoomed(const Image& small) {
  Image out(kZoom * small.width, kZoom * small.height, 3);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) out.set_rgb(x, y, small.rgb(x / kZoom, y / kZoom));
  }
  return out;
}

void write_maps(const RenderRequest& request, const Image& maps) {
  if (keeps_layers(request.out)) return image::write_exr(request.out, {{"", &maps}});
  const double exposure = request.exposure.exposure.value_or(double{image::auto_exposure(maps)}) *
                          std::exp2(request.exposure.ev);
  image::write_png(request.out, image::display(zoomed(maps), static_cast<float>(exposure)));
}

nlohmann::json triple(const Vec3& v) { return {v.x, v.y, v.z}; }

void check_flags(const RenderRequest& request) {
  if (request.point.empty())
    throw CLI::ValidationError("--point", "name the place, such as 1,0.5,2, of --output incident");
  LTE_CHECK(!request.named_by_scene || !std::filesystem::exists(request.out), request.out,
            ": exists; name the picture in --out to replace it");
  LTE_CHECK(request.mode == "neural" && request.turntable == 0 && !request.edit.any(),
            "--output incident shows the network beside paths: it goes with neither --mode "
            "reference nor --turntable nor --edit");
}

/// The files that are read and written, checked before anything is.
void claim_map_files(const RenderRequest& request, CommandFiles* files) {
  claim_scene(request, files);
  claim_embedding(request.embedding, files);
  files->reads("--checkpoint", request.checkpoint);
  files->writes("--out", request.out);
  files->writes_common(request.tool.common);
  files->check();
}

}  // namespace

Image maps_side_by_side(std::span<const Rgb> left, std::span<const Rgb> right, int bins) {
  Image out(2 * bins + 1, bins, 3);
  for (int y = 0; y < bins; ++y) {
    for (int x = 0; x < bins; ++x) {
      const auto cell = static_cast<size_t>(y * bins + x);
      out.set_rgb(x, y, left[cell]);
      out.set_rgb(bins + 1 + x, y, right[cell]);
    }
  }
  return out;
}

void run_incident_map(const RenderRequest& request) {
  check_flags(request);
  check_draws(request.embedding);
  const Vec3 place{request.point[0], request.point[1], request.point[2]};
  CommandFiles files;
  claim_map_files(request, &files);
  apply_tool_options(request.tool);
  check_writable(request.out);
  check_writable(request.tool.common.json);
  const scene::Scene scene = load_source(request, request.camera);
  describe(scene, request.scene);
  const std::filesystem::path checkpoint = checkpoint_or_shipped(request.checkpoint);
  const runtime::Network network(checkpoint, network_options(request.tool));
  files.check_what_was_read();
  LTE_CHECK(network.config().predicts_radiance(), checkpoint.string(),
            ": has no radiance decoder (its model.radiance_lobes is 0)");
  check_size(request.scene, scene, network, request.embedding.rescale);
  Renderer renderer(scene);
  const scene::ClosestPoint closest = scene::closest_point(scene, place);
  const scene::Surface& at = closest.surface;
  const runtime::MemoryLimit memory(request.tool.max_memory_mb);
  provide_embedding(request.embedding, network,
                    embed_settings(request.embedding, request.seed, memory), &renderer);
  const std::vector<Vec3> directions = pathtrace::bin_centres(kBins, at.normal);
  const std::vector<Rgb> neural = renderer.draws().decode_radiance(
      {{&at.position, 1}, {&at.normal, 1}, {&at.albedo, 1}}, directions);
  const std::vector<Rgb> traced = traced_map(renderer, at, request);
  write_maps(request, maps_side_by_side(neural, traced, kBins));
  const double error = log_relative_error(neural, traced, renderer.embedding().mean_emission());
  if (!request.tool.common.json.empty()) {
    const nlohmann::json json = {{"out", request.out},          {"point", triple(at.position)},
                                 {"normal", triple(at.normal)}, {"distance", closest.distance},
                                 {"paths", request.spp},        {"logrel", error}};
    write_file(request.tool.common.json, json.dump(2) + "\n");
  }
  if (request.tool.common.quiet) return;
  std::printf(
      "%s: radiance at (%.3f, %.3f, %.3f), %.3f m from the place asked for; left the network, "
      "right %d paths a direction: logrel %.4f\n",
      request.out.c_str(), double{at.position.x}, double{at.position.y}, double{at.position.z},
      double{closest.distance}, request.spp, error);
}

}  // namespace lte::infer
