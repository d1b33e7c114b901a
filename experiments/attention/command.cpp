// Pictures of a network's attention: how much each latent counts in the answer at a surface point,
// or where a block of the encoder found what the latent at that point knows. Values are multiples
// of an even share, painted on the surfaces that the camera sees.
#include "experiments/command.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/begin_command.h"
#include "bench/pareto/pareto.h"
#include "experiments/attention/closest_point.h"
#include "experiments/attention/scene_attention.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/picture_size.h"
#include "infer/tool/tool_options.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/cli/assets.h"
#include "lte/cli/numbers.h"
#include "lte/cli/scene_flags.h"
#include "lte/image/png.h"
#include "lte/image/tonemap.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/scene/load_camera.h"

namespace lte::experiments {
namespace {

const std::string kDecoder = "decoder";
constexpr float kReach = 0.05f;     // of the scene's widest side, from --point to a surface
constexpr float kMinShade = 0.35f;  // of surfaces seen at a slant
constexpr float kGray = 0.25f;      // display value of surfaces without attention

struct Request {
  std::string scene, checkpoint, camera, size = "640x480", out;
  std::vector<float> point;
  std::string block = kDecoder;
  int64_t head = SceneAttention::kAllHeads;
  SceneFlags loading;
  CommonOptions common;
};

void add_options(CLI::App& app, Request* request) {
  app.add_option("SCENE", request->scene, "Scene")->required();
  app.add_option("--point", request->point, "X,Y,Z of a point on or near a surface")
      ->required()
      ->delimiter(',')
      ->expected(3);
  app.add_option("--block", request->block,
                 "decoder: weights of the latents in the answer at the point; decoder.L: of one of "
                 "its layers; or a block of the encoder such as down0.0")
      ->capture_default_str();
  app.add_option("--head", request->head, "A head of the encoder's block; by default their mean")
      ->check(non_negative_number());
  app.add_option("--checkpoint", request->checkpoint, "Model; by default the shipped one");
  app.add_option("--camera", request->camera,
                 concat(scene::kCameraHelp, "; by default the scene's first, else auto"));
  app.add_option("--size", request->size, "Size of the picture")
      ->check(CLI::Validator(infer::check_picture_size, "WxH"))
      ->capture_default_str();
  app.add_option("--out", request->out, "Picture to write (.png)")->required();
  add_scene_flags(app, &request->loading);
  add_common_options(app, &request->common);
}

/// The surface point nearest to --point, on the side that the camera sees.
scene::Surface point_of(const Request& request, const pathtrace::Bvh& bvh, const Vec3& viewer) {
  const Vec3 place{request.point[0], request.point[1], request.point[2]};
  const float reach = kReach * max_component(bvh.bounds().extent());
  ClosestPoint found = closest_point(bvh.scene(), place);
  LTE_CHECK(found.distance <= reach, "--point ", place.x, ",", place.y, ",", place.z,
            ": there is no surface within ", reach, " m of it");
  if (dot(found.surface.normal, viewer - found.surface.position) < 0)
    found.surface.normal = -found.surface.normal;
  return found.surface;
}

[[noreturn]] void refuse_block(const SceneAttention& inside, const std::string& name) {
  std::string known =
      concat(kDecoder, ", ", kDecoder, ".0 to ", kDecoder, '.', inside.decoder_layers() - 1);
  for (const AttentionBlock& block : inside.blocks()) known += ", " + block.name;
  throw Error(concat("--block ", name, ": the model has ", known));
}

/// A value a latent: 0 for those that the point does not read.
std::vector<float> decoder_values(const SceneAttention& inside, const scene::Surface& at,
                                  const Request& request) {
  LTE_CHECK(request.head == SceneAttention::kAllHeads, "--head ", request.head,
            ": the decoder has none, but a weight a channel, of which the mean is shown");
  const LatentsRead read = inside.read(at.position, at.normal, at.albedo);
  const std::vector<float>* shares = &read.share;
  if (request.block != kDecoder) {
    const char* const last = request.block.data() + request.block.size();
    size_t layer = 0;
    const auto [end, error] =
        std::from_chars(request.block.data() + kDecoder.size() + 1, last, layer);
    if (error != std::errc() || end != last || layer >= read.by_layer.size())
      refuse_block(inside, request.block);
    shares = &read.by_layer[layer];
  }
  std::vector<float> out(inside.positions().size());
  for (size_t k = 0; k < read.latent.size(); ++k)
    out[static_cast<size_t>(read.latent[k])] =
        (*shares)[k] * static_cast<float>(read.latent.size());
  return out;
}

std::vector<float> values_of(const SceneAttention& inside, const scene::Surface& at, int64_t latent,
                             const Request& request) {
  if (request.block == kDecoder || request.block.starts_with(kDecoder + '.'))
    return decoder_values(inside, at, request);
  const std::vector<AttentionBlock>& blocks = inside.blocks();
  for (size_t b = 0; b < blocks.size(); ++b) {
    if (blocks[b].name != request.block) continue;
    LTE_CHECK(request.head < blocks[b].heads, "--head ", request.head, ": block ", blocks[b].name,
              " has ", blocks[b].heads);
    return inside.attention(b, request.head, latent);
  }
  refuse_block(inside, request.block);
}

image::Image paint(const SceneAttention& inside, const std::vector<float>& values,
                   const pathtrace::GBuffer& hits, const scene::Camera& camera) {
  std::vector<Vec3> position, normal;
  std::vector<size_t> pixels;
  for (size_t i = 0; i < hits.mask.size(); ++i) {
    if (hits.mask[i] == 0) continue;
    position.push_back(hits.position[i]);
    normal.push_back(hits.normal[i]);
    pixels.push_back(i);
  }
  const std::vector<float> shown = inside.interpolate(values, position, normal);
  image::Image scalar(hits.width, hits.height, 1);
  for (size_t k = 0; k < pixels.size(); ++k) scalar.pixels[pixels[k]] = shown[k];
  const float most = std::max(1e-6f, *std::max_element(values.begin(), values.end()));
  image::Image picture = image::heat_map(scalar, most);
  for (size_t k = 0; k < pixels.size(); ++k) {
    const float slant = std::abs(dot(normal[k], normalize(camera.origin - position[k])));
    const float shade = kMinShade + (1 - kMinShade) * slant;
    const float gray = kGray * std::max(0.0f, 1 - 10 * shown[k] / most);
    picture.set_rgb(pixels[k], (picture.rgb(pixels[k]) + Rgb{gray, gray, gray}) * shade);
  }
  return picture;
}

void run(const Request& request) {
  CommandFiles files;
  files.reads("SCENE", request.scene);
  files.reads("--checkpoint", request.checkpoint);
  bench::begin_command(request.common, &files, request.out);
  const auto [width, height] = infer::parse_picture_size(request.size);
  const scene::Scene scene = load_scene(request.scene, request.loading);
  const runtime::Network network(checkpoint_or_shipped(request.checkpoint));
  infer::Renderer renderer(scene);
  infer::EmbedSettings embedding;
  embedding.rescale = true;
  embedding.record_attention = true;
  renderer.embed(network, embedding);
  const scene::Camera camera =
      bench::pareto_views(renderer.bvh(), request.camera, 1,
                          static_cast<float>(width) / static_cast<float>(height))
          .front();
  const scene::Surface at = point_of(request, renderer.bvh(), camera.origin);
  const SceneAttention inside(renderer.shared_embedding());
  const int64_t latent = inside.latent_at(at.position, at.normal);
  const std::vector<float> values = values_of(inside, at, latent, request);
  files.check_what_was_read();
  image::write_png(
      request.out,
      paint(inside, values, trace_gbuffer(renderer.bvh(), camera, width, height), camera));
  double sum = 0;
  for (const float value : values) sum += double{value};
  const float most = *std::max_element(values.begin(), values.end());
  std::printf("attention of %s at %g,%g,%g: full color is %g times an even share\n",
              request.block.c_str(), double{at.position.x}, double{at.position.y},
              double{at.position.z}, double{most});
  if (request.common.json.empty()) return;
  const nlohmann::json json = {{"block", request.block},
                               {"head", request.head},
                               {"latent", latent},
                               {"latents", values.size()},
                               {"sum", sum},
                               {"most", most},
                               {"read", std::count_if(values.begin(), values.end(),
                                                      [](float value) { return value != 0; })}};
  write_file(request.common.json, json.dump(1) + "\n");
}

}  // namespace

std::function<void()> add_command(CLI::App* app) {
  const auto request = std::make_shared<Request>();
  app->name("experiment_attention");
  app->description("Pictures of a network's attention.");
  add_options(*app, request.get());
  return [request] { run(*request); };
}

}  // namespace lte::experiments
