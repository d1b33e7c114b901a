#include "infer/render/render_command.h"

#include <charconv>
#include <cstdio>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "infer/common/assets.h"
#include "infer/common/picture_memory.h"
#include "infer/common/picture_size.h"
#include "infer/common/renderer.h"
#include "infer/common/untrained_light.h"
#include "infer/render/frame_io.h"
#include "infer/render/frame_set.h"
#include "infer/render/notes.h"
#include "infer/render/scene_size.h"
#include "infer/render/time_budget.h"
#include "infer/render/views.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/process_memory.h"
#include "lte/base/timer.h"
#include "lte/cli/command_files.h"
#include "lte/cli/numbers.h"
#include "lte/nn/device.h"
#include "lte/scene/light_points.h"
#include "lte/scene/load_camera.h"

namespace lte::infer {
namespace {

constexpr int kMostSubHits = 256;

std::string check_picture(const std::string& path) {
  return is_picture_path(path) ? "" : concat("\"", path, "\" ends neither in .exr nor in .png");
}

/// "off" -> 0, "8" -> 8; -1 if it is anything else.
int parse_antialias(const std::string& text) {
  if (text == "off") return 0;
  int hits = 0;
  const auto [at, error] = std::from_chars(text.data(), text.data() + text.size(), hits);
  const bool whole = error == std::errc() && at == text.data() + text.size();
  return whole && hits >= 1 && hits <= kMostSubHits ? hits : -1;
}

std::string check_antialias(const std::string& text) {
  if (parse_antialias(text) >= 0) return "";
  return concat("\"", text, "\": expected off, or hits a pixel from 1 to ", kMostSubHits);
}

std::string check_time_budget(const std::string& text) {
  try {
    parse_time_budget(text);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

RenderSettings settings_of(const RenderRequest& request) {
  RenderSettings settings;
  settings.output = parse_enum<Output>("--output", request.output);
  settings.mode = parse_enum<Mode>("--mode", request.mode);
  std::tie(settings.width, settings.height) = parse_picture_size(request.size);
  settings.direct_samples = request.direct_samples;
  settings.adaptive_direct = request.adaptive_direct;
  settings.denoise = parse_enum<Denoise>("--denoise", request.denoise);
  settings.spp = request.spp;
  settings.max_depth = request.max_depth;
  settings.seed = request.seed;
  settings.antialias = parse_antialias(request.antialias);
  settings.metal = parse_enum<Metal>("--metal", request.metal);
  settings.layers = keeps_layers(request.out);
  // The rest of the quality stands in the request already (apply_quality()).
  return with_quality(parse_enum<Quality>("--quality", request.quality),
                      parse_enum<Sparse>("--sparse", request.sparse), {true, true, true}, settings);
}

/// Sets what the quality says in the place of flags that were not given.
void apply_quality(const CLI::App& app, RenderRequest* r) {
  r->given.direct_samples = app.count("--direct-samples") > 0;
  r->given.antialias = app.count("--aa") > 0;
  r->given.sparse = app.count("--sparse") > 0;
  const QualitySettings chosen = quality_settings(parse_enum<Quality>("--quality", r->quality));
  if (!r->given.direct_samples) r->direct_samples = chosen.direct_samples;
  if (!r->given.antialias)
    r->antialias = chosen.antialias > 0 ? std::to_string(chosen.antialias) : "off";
}

void check_dial(const RenderRequest& request) {
  LTE_CHECK(request.time_budget.empty() || request.mode == "neural",
            "--time-budget needs --mode neural: a reference takes --spp paths a pixel");
  LTE_CHECK(request.sparse != "on" || request.mode == "neural",
            "--sparse on needs --mode neural: a reference asks every pixel");
}

std::vector<View> views_of(const RenderRequest& request, const pathtrace::Bvh& bvh) {
  const auto [width, height] = parse_picture_size(request.size);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  std::vector<View> views =
      request.turntable > 0 ? turntable_views(bvh, request.camera, request.turntable, request.out,
                                              request.seed, aspect)
                            : choose_views(bvh, request.camera, request.out, request.seed, aspect);
  check_in_view(bvh.scene(), bvh.bounds(), views, aspect);
  for (const View& view : views) check_writable(view.out);
  return views;
}

nlohmann::json seconds_json(const StageSeconds& s, double total) {
  nlohmann::json out = {{"total", total}};
  for (const Stage& stage : kStages) out[stage.name] = s.*stage.seconds;
  return out;
}

nlohmann::json sparse_json(const gi::SparseOptions& options) {
  return {{"step", options.step},
          {"edge_step", options.edge_step},
          {"tolerance", options.tolerance},
          {"contact_radius", options.contact_radius}};
}

/// What there is to say about a picture that has been written.
nlohmann::json picture_json(const RenderRequest& request, const View& view, const PicturePlan& plan,
                            const Frame& frame, double exposure) {
  const RenderSettings& settings = plan.settings;
  const bool sparse = settings.sparse.has_value();
  return {{"out", view.out},
          {"camera", nlohmann::json::parse(scene::camera_json(view.camera))},
          {"exposure", exposure},
          {"ev", request.exposure.ev},
          {"background_pixels", frame.background},
          {"queries", frame.queries},
          {"decoded_pixels", sparse && frame.decoded > 0 ? frame.decoded : frame.queries},
          {"quality", enum_name(plan.quality)},
          {"sparse", sparse ? sparse_json(*settings.sparse) : nlohmann::json(false)},
          {"antialias", settings.antialias},
          {"direct_samples",
           plan.pace ? plan.pace->mean_rays() : static_cast<double>(settings.direct_samples)},
          {"edge_pixels", frame.edge_pixels},
          {"traced_pixels", frame.traced_pixels}};
}

/// The keys of one picture stand beside those of the run; several are a list of their own.
nlohmann::json to_json(const RenderRequest& request, const Renderer& renderer,
                       const nlohmann::json& pictures, const StageSeconds& s, double total) {
  const auto [width, height] = parse_picture_size(request.size);
  nlohmann::json json = {{"scene", request.scene},
                         {"output", request.output},
                         {"mode", request.mode},
                         {"precision", request.tool.precision},
                         {"size", {width, height}},
                         {"pruned_scene_points", renderer.pruned_points().pruned},
                         {"denoiser", renderer.denoised_by()},
                         {"seconds", seconds_json(s, total)},
                         {"peak_rss_mb", peak_rss_mb()}};
  if (!request.time_budget.empty())
    json["time_budget_seconds"] = parse_time_budget(request.time_budget);
  if (pictures.size() == 1) {
    json.update(pictures[0]);
    return json;
  }
  json["pictures"] = pictures;
  for (const nlohmann::json& picture : pictures) json["camera_list"].push_back(picture["camera"]);
  return json;
}

void print_exposure(const RenderRequest& request, const View& view, double exposure,
                    const char* end) {
  if (request.tool.common.quiet) return;
  std::printf("%s: exposure %.4g", view.out.c_str(), exposure);
  if (request.exposure.ev != 0) std::printf(" (ev %+g)", request.exposure.ev);
  std::fputs(end, stdout);
  std::fflush(stdout);
}

void print_times(const RenderRequest& request, const StageSeconds& s, double total) {
  if (request.tool.common.quiet) return;
  std::printf(" | seconds: ");
  for (const Stage& stage : kStages) std::printf("%s %.2f, ", stage.name, s.*stage.seconds);
  std::printf("total %.2f | peak %.0f MiB\n", total, peak_rss_mb());
}

/// @throws lte::Error if an output would replace an input or another output
void claim_files(const RenderRequest& request, CommandFiles* files) {
  claim_scene(request, files);
  claim_embedding(request.embedding, files);
  files->reads("--checkpoint", request.checkpoint);
  files->reads("--camera", request.camera);
  files->writes("--out", request.out);
  files->writes_common(request.tool.common);
  files->check();
}

/// The same of the files of several views, whose names are made from --out.
void claim_views(const RenderRequest& request, const std::vector<View>& views,
                 CommandFiles* files) {
  for (const View& view : views) {
    if (view.out != request.out) files->writes("--out", view.out);
  }
  files->check();
}

/// The network if this picture needs one. Where the scene has light that it has never seen, paths
/// answer in its place, unless the flag says otherwise.
std::optional<runtime::Network> load_network(const RenderRequest& request, const Renderer& renderer,
                                             RenderSettings* settings) {
  if (!renderer.needs_network(*settings)) return std::nullopt;
  const c10::Device device = nn::choose_device(request.tool.device, 0, "--device");
  std::optional<runtime::Network> network(
      std::in_place, checkpoint_or_shipped(request.checkpoint),
      runtime::NetworkOptions{device, choose_precision(request.tool.precision, device)});
  const scene::Scene& scene = renderer.bvh().scene();
  if (!has_untrained_light(scene, network->metadata())) return network;
  if (request.untrained_light == "network") {
    log_warning(untrained_light_note(scene, network->metadata()));
    return network;
  }
  log_info(traced_light_note(scene, settings->spp));
  settings->indirect = Indirect::Paths;
  return std::nullopt;
}

int64_t scene_points(const RenderRequest& request, const runtime::Network& network) {
  return request.scene_points > 0 ? request.scene_points : network.metadata().scene_points;
}

void embed(const RenderRequest& request, const runtime::Network& network,
           const runtime::MemoryLimit& memory, Renderer* renderer) {
  EmbedSettings settings;
  settings.scene_points = scene_points(request, network);
  settings.seed = request.seed;
  settings.rescale = request.rescale;
  if (request.prune != "auto") settings.prune = request.prune == "on";
  settings.memory = memory;
  provide_embedding(request.embedding, network, settings, renderer);
  memory.check("encoding the scene", {runtime::Remedy::FewerScenePoints});
}

/// Adds the stages that each picture has of its own.
void add_seconds(const StageSeconds& picture, StageSeconds* sum) {
  for (double StageSeconds::*stage :
       {&StageSeconds::primary, &StageSeconds::decode, &StageSeconds::direct,
        &StageSeconds::denoise, &StageSeconds::reference, &StageSeconds::write}) {
    sum->*stage += picture.*stage;
  }
}

/// The switches of a picture: as the flags have them, or as the time that is left allows.
PicturePlan plan_of(const RenderRequest& request, const RenderSettings& base, const View& view,
                    const Timer& work, Renderer* renderer) {
  if (request.time_budget.empty())
    return {parse_enum<Quality>("--quality", request.quality), base, nullptr};
  PicturePlan plan = plan_picture(parse_time_budget(request.time_budget), work,
                                  parse_enum<Sparse>("--sparse", request.sparse), request.given,
                                  base, view.camera, renderer);
  log_info(view.out, ": ", enum_name(plan.quality), " quality fits into ", request.time_budget);
  return plan;
}

/// What is on disk of the pictures of a pattern; nothing for a picture whose name was given.
std::optional<FrameSet> frames_of(const RenderRequest& request, const std::vector<View>& views,
                                  const scene::Scene& scene,
                                  const std::optional<runtime::Network>& network) {
  const bool named = views.front().out == request.out;
  if (request.validate_only) return std::nullopt;
  LTE_CHECK(!named || !request.resume,
            "--resume goes with several pictures: --turntable, or --camera with a list or all");
  if (named) return std::nullopt;
  return FrameSet(request.out,
                  frame_settings(*request.flags, scene, network ? &*network : nullptr));
}

/// The exposure of a picture; of the first one for all frames that share it.
float exposure_of(const RenderRequest& request, const Frame& frame, Output output,
                  std::optional<FrameSet>* frames) {
  ExposureOptions options = request.exposure;
  const bool shared = *frames && (request.one_exposure || request.turntable > 0);
  if (shared && !options.exposure)
    options.exposure = (*frames)->shared_exposure(double{frame_exposure(frame, output)});
  return choose_exposure(frame, output, options);
}

/// What is left to do when the scene is encoded.
struct PictureRun {
  std::vector<View> views;
  RenderSettings settings;  ///< but for what a time budget decides
  std::optional<FrameSet> frames;
  Timer total;
  Timer work;  ///< since the scene points were drawn
};

void render_to_files(const RenderRequest& request, PictureRun run, Renderer* renderer) {
  StageSeconds seconds = renderer->seconds();
  nlohmann::json pictures = nlohmann::json::array();
  if (run.frames && !run.views.empty()) run.frames->write_manifest();
  for (const View& view : run.views) {
    PicturePlan plan = plan_of(request, run.settings, view, run.work, renderer);
    RenderSettings& settings = plan.settings;
    Frame frame;
    {
      const PictureProgress progress(&settings);
      frame = renderer->render(view.camera, settings);
    }
    report_metal(request.scene, settings, frame);
    if (frame.background == int64_t{settings.width} * settings.height &&
        !renderer->has_environment()) {
      log_warning(request.scene, ": camera ", view.camera.name,
                  " sees no surface; the picture is black");
    }
    const float exposure = exposure_of(request, frame, settings.output, &run.frames);
    const Timer write;
    write_frame(view.out, frame, settings.output, exposure, &view.camera);
    renderer->seconds().write = write.seconds();
    add_seconds(renderer->seconds(), &seconds);
    pictures.push_back(picture_json(request, view, plan, frame, exposure));
    print_exposure(request, view, exposure, run.views.size() > 1 ? "\n" : "");
    run.work.restart();  // a view after the first has the budget for itself
  }
  if (!request.tool.common.json.empty()) {
    const nlohmann::json json = to_json(request, *renderer, pictures, seconds, run.total.seconds());
    write_file(request.tool.common.json, json.dump(2) + '\n');
  }
  if (run.views.size() != 1 && !request.tool.common.quiet)
    std::printf("%zu pictures", run.views.size());
  print_times(request, seconds, run.total.seconds());
}

}  // namespace

void add_render_options(CLI::App& app, RenderRequest* r) {
  r->flags = &app;
  app.add_option("scene", r->scene, "Scene to render: .gltf, .glb, .pbrt, .obj or .ply")
      ->required();
  app.add_option("--out", r->out,
                 "Picture to write: .exr (linear, with layers) or .png; with several cameras a "
                 "pattern, %d or %04d for the number and {name} for the camera's name")
      ->check(CLI::Validator(check_picture, "FILE.exr|FILE.png"));
  app.add_option("--checkpoint", r->checkpoint, "Model; by default the shipped one");
  app.add_option("--camera,--cameras", r->camera,
                 concat(scene::kCameraHelp, "; by default the scene's first camera, else auto"));
  app.add_option("--turntable", r->turntable,
                 "So many cameras that turn around the scene, or in place inside a room, from the "
                 "one of --camera (by default auto) on; --out is a pattern")
      ->check(CLI::Range(1, 100'000));
  app.add_flag("--resume", r->resume,
               "Several pictures: keep those that exist and make the rest, if they were made with "
               "the same settings; without it a picture that exists is an error");
  app.add_option("--size", r->size, "Picture size")
      ->check(CLI::Validator(check_picture_size, "WxH"))
      ->capture_default_str();
  app.add_option("--output", r->output,
                 "What to show; gi is reflected indirect light, irradiance is it untextured")
      ->check(CLI::IsMember({"full", "gi", "irradiance", "direct", "albedo", "normal", "depth"}))
      ->capture_default_str();
  app.add_option("--mode", r->mode,
                 "The network, or the path-traced reference of the same quantity")
      ->check(CLI::IsMember({"neural", "reference"}))
      ->capture_default_str();
  app.add_option("--quality", r->quality,
                 "Neural mode, flags by hand win: draft (sparse answers, 4 shadow rays, no "
                 "anti-aliasing), preview (sparse answers, 16 rays, --aa 4) or final (an answer a "
                 "pixel, 64 rays, --aa 16)")
      ->check(CLI::IsMember({"draft", "preview", "final"}))
      ->capture_default_str();
  app.add_option("--time-budget", r->time_budget,
                 "Neural mode: instead of --quality, the best that is ready in a time such as 0.5s "
                 "or 200ms, encoding included; reading the scene and writing the picture are not")
      ->check(CLI::Validator(check_time_budget, "TIME"))
      ->excludes("--quality");
  app.add_option("--sparse", r->sparse,
                 "Neural mode: ask the network at few pixels and interpolate between them (on), at "
                 "every pixel (off), or as the quality has it (auto)")
      ->check(CLI::IsMember({"auto", "off", "on"}))
      ->capture_default_str();
  app.parse_complete_callback([&app, r] { apply_quality(app, r); });
  app.add_option(
         "--aa", r->antialias,
         "Hits a pixel at edges, which share the answers of pixels; or off. A full reference "
         "spreads its paths over the pixel instead")
      ->check(CLI::Validator(check_antialias, "off|N"))
      ->capture_default_str();
  app.add_option("--metal", r->metal,
                 "Neural mode: what stands for metal, which the network does not know: paths "
                 "(--spp a pixel), a matt surface of its color, or black")
      ->check(CLI::IsMember({"diffuse", "black", "trace"}))
      ->capture_default_str();
  app.add_option("--untrained-light", r->untrained_light,
                 "Neural mode: who answers for indirect light in a scene with directional lights "
                 "if the model was trained without any: paths (--spp a pixel), or the network, "
                 "wrongly")
      ->check(CLI::IsMember({"trace", "network"}))
      ->capture_default_str();
  app.add_option("--spp", r->spp,
                 "Paths a pixel: in reference mode, for metal, and for untrained light")
      ->check(CLI::Range(1, 1 << 24))
      ->capture_default_str();
  app.add_option("--max-depth", r->max_depth, "Of these paths: surface hits after the first")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--direct-samples", r->direct_samples, "Neural mode: shadow rays a pixel")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_flag("--adaptive-direct", r->adaptive_direct,
               "Neural mode: share the shadow rays out, more where penumbrae are; "
               "--direct-samples is their mean");
  app.add_option("--denoise", r->denoise,
                 "Take noise out of direct light, or with --mode reference out of all light, by "
                 "Open Image Denoise where it is found ($LTE_OIDN), else by a filter of lte's; "
                 "auto: in neural mode up to 16 shadow rays a pixel")
      ->check(CLI::IsMember({"auto", "on", "off"}))
      ->capture_default_str();
  app.add_option("--scene-points", r->scene_points,
                 "Scene points shown to the network; 0 for as many as in training")
      ->check(CLI::Range(int64_t{0}, int64_t{1} << 28));
  app.add_option("--prune", r->prune,
                 "Show the network only surfaces that light reaches; auto: as in its training")
      ->check(CLI::IsMember({"auto", "on", "off"}))
      ->capture_default_str();
  app.add_flag("--rescale,!--no-rescale", r->rescale,
               "Shrink a scene larger than the model knows, for the network only (the default), or "
               "refuse it");
  add_embedding_flags(app, &r->embedding);
  add_exposure_options(app, &r->exposure);
  app.add_flag("--one-exposure", r->one_exposure,
               "Several pictures: all take the exposure of the first, as with --turntable");
  app.add_option("--seed", r->seed, "Seed of scene points and light samples")
      ->capture_default_str();
  app.add_flag("--validate-only", r->validate_only,
               "Check scene, camera and flags, and write nothing");
  add_scene_options(app, r);
  add_tool_options(app, &r->tool);
}

void run_render(const RenderRequest& request) {
  if (request.out.empty() && !request.validate_only) {
    throw CLI::ValidationError("--out",
                               "name the picture to write (.exr or .png), or pass --validate-only");
  }
  check_dial(request);
  CommandFiles files;
  claim_files(request, &files);
  apply_tool_options(request.tool);
  check_writable(request.out);
  check_writable(request.tool.common.json);
  check_writable(request.embedding.save);
  RenderSettings settings = settings_of(request);
  check_picture_fits(settings, available_memory_mb());
  const Timer total;
  const bool turns = request.turntable > 0 && request.camera.empty();  // from the automatic one on
  const scene::Scene scene = load_source(request, turns ? "auto" : request.camera);
  describe(scene, request.scene);
  Renderer renderer(scene);
  std::vector<View> views = views_of(request, renderer.bvh());
  claim_views(request, views, &files);
  say_unit(request.scene, renderer.bvh());
  if (!renderer.has_light())
    log_warning(request.scene,
                ": nothing emits light; every output with light in it is black "
                "(--environment 1,1,1 or --add-light auto gives it some)");
  const std::optional<runtime::Network> network = load_network(request, renderer, &settings);
  files.check_what_was_read();
  renderer.seconds().load = total.seconds();
  const runtime::MemoryLimit memory(request.tool.max_memory_mb);
  if (network) {
    check_size(request.scene, scene, *network, request.rescale);
    const std::string note = untrained_environment_note(scene, network->metadata());
    if (!note.empty()) log_warning(note);
    if (request.embedding.load.empty())
      memory.check_encoding(network->config(), scene_points(request, *network));
  }
  check_picture_fits(settings, memory);
  LTE_CHECK(network || !request.embedding.any(), request.embedding.load, request.embedding.save,
            ": this picture needs no embedding (--mode, --output, or a scene without light)");
  std::optional<FrameSet> frames = frames_of(request, views, scene, network);
  if (request.validate_only) {  // as lte_datagen says it, and under --quiet too: it is the result
    std::printf("%s: valid scene, %lld triangles, %zu light groups\n", request.scene.c_str(),
                static_cast<long long>(scene.triangle_count()), scene.light_groups.size());
    return;
  }
  if (frames) {
    files.writes("--out", frames->manifest());
    files.check();
    views = frames->missing(views, request.resume);
  }
  const Timer work;
  if (network && (!views.empty() || !request.embedding.save.empty())) {
    embed(request, *network, memory, &renderer);
    check_picture_fits(settings, memory);
  }
  render_to_files(request, {std::move(views), settings, std::move(frames), total, work}, &renderer);
}

}  // namespace lte::infer
