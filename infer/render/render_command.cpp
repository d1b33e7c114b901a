#include "infer/render/render_command.h"

#include <charconv>
#include <cstdio>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "infer/common/assets.h"
#include "infer/common/renderer.h"
#include "infer/render/frame_io.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/process_memory.h"
#include "lte/base/timer.h"
#include "lte/cli/command_files.h"
#include "lte/cli/numbers.h"
#include "lte/nn/device.h"
#include "lte/pathtrace/auto_camera.h"
#include "lte/scene/environment_points.h"
#include "lte/scene/import/environment_file.h"
#include "lte/scene/load.h"
#include "lte/scene/load_camera.h"

namespace lte::infer {
namespace {

constexpr int kLargestSide = 65'536;
// Floats a pixel that a frame and its G-buffer hold at once, with the query arrays and one block of
// results.
constexpr double kFloatsPerPixel = 64;

/// "640x480" -> {640, 480}; {0, 0} if it is anything else.
std::pair<int, int> parse_size(const std::string& text) {
  const char *at = text.data(), *end = at + text.size();
  int width = 0, height = 0;
  const auto first = std::from_chars(at, end, width);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != 'x') return {0, 0};
  const auto second = std::from_chars(first.ptr + 1, end, height);
  if (second.ec != std::errc() || second.ptr != end) return {0, 0};
  const auto fits = [](int side) { return side > 0 && side <= kLargestSide; };
  return fits(width) && fits(height) ? std::pair(width, height) : std::pair(0, 0);
}

std::string check_size(const std::string& text) {
  if (parse_size(text).first > 0) return "";
  return concat("\"", text, "\" is no size: expected WIDTHxHEIGHT, both from 1 to ", kLargestSide);
}

std::string check_picture(const std::string& path) {
  return is_picture_path(path) ? "" : concat("\"", path, "\" ends neither in .exr nor in .png");
}

RenderSettings settings_of(const RenderRequest& request) {
  RenderSettings settings;
  settings.output = parse_output(request.output);
  settings.mode = parse_mode(request.mode);
  std::tie(settings.width, settings.height) = parse_size(request.size);
  settings.direct_samples = request.direct_samples;
  settings.spp = request.spp;
  settings.max_depth = request.max_depth;
  settings.seed = request.seed;
  return settings;
}

scene::Camera choose_camera(const RenderRequest& request, const scene::Scene& scene,
                            const pathtrace::Bvh& bvh) {
  if (!request.camera.empty() && request.camera != "auto")
    return scene::load_camera(request.camera);
  if (request.camera.empty() && !scene.cameras.empty()) return scene.cameras.front();
  const scene::Camera camera = pathtrace::auto_camera(bvh, request.seed);
  log_info("camera: auto, origin ", camera.origin.x, " ", camera.origin.y, " ", camera.origin.z,
           ", target ", camera.target.x, " ", camera.target.y, " ", camera.target.z);
  return camera;
}

void describe(const scene::Scene& scene, const std::string& path) {
  const Vec3 extent = scene.bounds().extent();
  log_info(path, ": ", scene.triangle_count(), " triangles, ", scene.instances.size(),
           " instances, ", scene.light_groups.size(), " lights, ", scene.cameras.size(),
           " cameras, ", extent.x, " x ", extent.y, " x ", extent.z, " m");
  for (const std::string& ignored : scene.ignored) log_warning(path, ": ignored ", ignored);
}

nlohmann::json seconds_json(const StageSeconds& s, double total) {
  nlohmann::json out = {{"total", total}};
  for (const Stage& stage : kStages) out[stage.name] = s.*stage.seconds;
  return out;
}

nlohmann::json to_json(const RenderRequest& request, const RenderSettings& settings,
                       const Renderer& renderer, const Frame& frame, const StageSeconds& s,
                       double exposure, double total) {
  return {{"scene", request.scene},
          {"out", request.out},
          {"output", request.output},
          {"mode", request.mode},
          {"precision", request.tool.precision},
          {"size", {settings.width, settings.height}},
          {"exposure", exposure},
          {"background_pixels", frame.background},
          {"decoded_pixels", frame.queries},
          {"pruned_scene_points", renderer.pruned_points().pruned},
          {"seconds", seconds_json(s, total)},
          {"peak_rss_mb", peak_rss_mb()}};
}

void print_times(const RenderRequest& request, const StageSeconds& s, double exposure,
                 double total) {
  if (request.tool.common.quiet) return;
  std::printf("%s: exposure %.4g | seconds: ", request.out.c_str(), exposure);
  for (const Stage& stage : kStages) std::printf("%s %.2f, ", stage.name, s.*stage.seconds);
  std::printf("total %.2f | peak %.0f MiB\n", total, peak_rss_mb());
}

/// @throws lte::Error if an output would replace an input or another output
void claim_files(const RenderRequest& request, CommandFiles* files) {
  files->reads("SCENE", request.scene);
  files->reads("--checkpoint", request.checkpoint);
  files->reads("--camera", request.camera);
  files->reads("--environment", request.environment);
  files->writes("--out", request.out);
  files->writes_common(request.tool.common);
  files->check();
}

/// The network if this picture needs one. Validation looks at a model only if one is named.
std::optional<runtime::Network> load_network(const RenderRequest& request,
                                             const Renderer& renderer) {
  if (!renderer.needs_network(settings_of(request))) return std::nullopt;
  if (request.validate_only && request.checkpoint.empty()) return std::nullopt;
  const c10::Device device = nn::choose_device(request.tool.device, 0, "--device");
  return runtime::Network(checkpoint_or_shipped(request.checkpoint),
                          {device, choose_precision(request.tool.precision, device)});
}

void embed(const RenderRequest& request, const runtime::Network& network,
           const runtime::MemoryLimit& memory, Renderer* renderer) {
  EmbedSettings settings;
  settings.scene_points = request.scene_points;
  settings.seed = request.seed;
  settings.rescale = request.rescale;
  if (request.prune != "auto") settings.prune = request.prune == "on";
  settings.memory = memory;
  renderer->embed(network, settings);
  memory.check("encoding the scene", {runtime::Remedy::FewerScenePoints});
}

/// Everything after the scene stands: what is timed as encode to write.
void render_to_file(const RenderRequest& request, const scene::Camera& camera, Renderer* renderer,
                    const runtime::MemoryLimit& memory, const Timer& total) {
  const RenderSettings settings = settings_of(request);
  memory.check_ahead(kFloatsPerPixel * 4 * settings.width * settings.height / (1 << 20),
                     concat("a picture of ", request.size), "take a smaller one",
                     {runtime::Remedy::FewerQueries});
  const Frame frame = renderer->render(camera, settings);
  if (frame.background == int64_t{settings.width} * settings.height &&
      !renderer->has_environment()) {
    log_warning(request.scene, ": the camera sees no surface; the picture is black");
  }
  const double exposure = request.exposure.value_or(frame_exposure(frame, settings.output));
  const Timer write;
  write_frame(request.out, frame, settings.output, static_cast<float>(exposure));
  StageSeconds& seconds = renderer->seconds();
  seconds.write = write.seconds();
  if (!request.tool.common.json.empty()) {
    const nlohmann::json json =
        to_json(request, settings, *renderer, frame, seconds, exposure, total.seconds());
    write_file(request.tool.common.json, json.dump(2) + '\n');
  }
  print_times(request, seconds, exposure, total.seconds());
}

}  // namespace

void add_render_options(CLI::App& app, RenderRequest* r) {
  app.add_option("scene", r->scene, "Scene to render: .gltf, .glb, .pbrt, .obj or .ply")
      ->required();
  app.add_option("--out", r->out, "Picture to write: .exr (linear, with layers) or .png")
      ->check(CLI::Validator(check_picture, "FILE.exr|FILE.png"));
  app.add_option("--checkpoint", r->checkpoint, "Model; by default the shipped one");
  app.add_option("--camera", r->camera,
                 "Camera JSON, or auto; by default the scene's first camera, else auto");
  app.add_option("--size", r->size, "Picture size")
      ->check(CLI::Validator(check_size, "WxH"))
      ->capture_default_str();
  app.add_option("--output", r->output,
                 "What to show; gi is reflected indirect light, irradiance is it untextured")
      ->check(CLI::IsMember({"full", "gi", "irradiance", "direct", "albedo", "normal", "depth"}))
      ->capture_default_str();
  app.add_option("--mode", r->mode,
                 "The network, or the path-traced reference of the same quantity")
      ->check(CLI::IsMember({"neural", "reference"}))
      ->capture_default_str();
  app.add_option("--spp", r->spp, "Reference mode: paths a pixel")
      ->check(CLI::Range(1, 1 << 24))
      ->capture_default_str();
  app.add_option("--max-depth", r->max_depth, "Reference mode: surface hits after the first")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--direct-samples", r->direct_samples, "Neural mode: shadow rays a pixel")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_option("--scene-points", r->scene_points,
                 "Scene points shown to the network; 0 for as many as in training")
      ->check(CLI::Range(int64_t{0}, int64_t{1} << 28));
  app.add_option("--prune", r->prune,
                 "Show the network only surfaces that light reaches; auto: as in its training")
      ->check(CLI::IsMember({"auto", "on", "off"}))
      ->capture_default_str();
  app.add_flag("--rescale", r->rescale,
               "Shrink a scene larger than the model knows, for the network only");
  app.add_option("--environment", r->environment,
                 "Light from all around, in the place of the scene's own: constant radiance R,G,B, "
                 "or an equirectangular picture (.exr, .hdr, .pfm; .png, .jpg), Y up, +X in its "
                 "middle");
  app.add_option("--environment-turn", r->environment_turn,
                 "Degrees by which to turn it about +Y, counter-clockwise from above");
  app.add_option("--exposure", r->exposure,
                 "Factor before the display curve of a PNG; by default from the picture")
      ->check(positive_number());
  app.add_option("--seed", r->seed, "Seed of scene points and light samples")
      ->capture_default_str();
  app.add_flag("--validate-only", r->validate_only,
               "Check scene, camera and flags, and write nothing");
  add_tool_options(app, &r->tool);
}

void run_render(const RenderRequest& request) {
  if (request.out.empty() && !request.validate_only) {
    throw CLI::ValidationError("--out",
                               "name the picture to write (.exr or .png), or pass --validate-only");
  }
  CommandFiles files;
  claim_files(request, &files);
  apply_tool_options(request.tool);
  check_writable(request.out);
  check_writable(request.tool.common.json);
  const Timer total;
  scene::Scene scene = scene::load_scene(request.scene);
  LTE_CHECK(!request.environment.empty() || request.environment_turn == 0,
            "--environment-turn needs --environment");
  if (!request.environment.empty())
    scene::set_environment(request.environment, request.environment_turn, &scene);
  describe(scene, request.scene);
  Renderer renderer(scene);
  const scene::Camera camera = choose_camera(request, scene, renderer.bvh());
  if (!renderer.has_light())
    log_warning(request.scene, ": nothing emits light; every output with light in it is black");
  const std::optional<runtime::Network> network = load_network(request, renderer);
  files.check_what_was_read();
  renderer.seconds().load = total.seconds();
  if (network) {
    network->check_fits(max_component(scene::point_bounds(scene).extent()), request.rescale);
  }
  if (request.validate_only) {  // as lte_datagen says it, and under --quiet too: it is the result
    std::printf("%s: valid scene, %lld triangles, %zu light groups\n", request.scene.c_str(),
                static_cast<long long>(scene.triangle_count()), scene.light_groups.size());
    return;
  }
  const runtime::MemoryLimit memory(request.tool.max_memory_mb);
  if (network) embed(request, *network, memory, &renderer);
  render_to_file(request, camera, &renderer, memory, total);
}

}  // namespace lte::infer
