#include "infer/render/render_command.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "infer/check/check_report.h"
#include "infer/check/checked_pixels.h"
#include "infer/render/edit_frames.h"
#include "infer/render/frame_io.h"
#include "infer/render/frame_set.h"
#include "infer/render/notes.h"
#include "infer/render/picture_writer.h"
#include "infer/render/render_report.h"
#include "infer/render/scene_size.h"
#include "infer/render/video.h"
#include "infer/render/views.h"
#include "infer/renderer/quality.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/picture_size.h"
#include "lte/base/checksum.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/process_memory.h"
#include "lte/base/random.h"
#include "lte/base/timer.h"
#include "lte/cli/assets.h"
#include "lte/cli/command_files.h"
#include "lte/cli/numbers.h"
#include "lte/cli/writable.h"
#include "lte/pathtrace/reach/lost_light.h"
#include "lte/scene/light_points.h"
#include "lte/scene/load_camera.h"

namespace lte::infer {
namespace {

/// Of a picture that is written while the next one is made.
constexpr int64_t kMaxPixelsBeside = int64_t{1} << 20;
/// Paths that check are independent of all that the picture has used.
constexpr uint64_t kCheckPaths = 36, kCheckedPlaces = 37;
/// The most that a check takes of a given time, but for its first paths.
constexpr double kCheckShare = 0.1;

std::vector<View> views_of(const RenderRequest& request, const pathtrace::Bvh& bvh) {
  const auto [width, height] = parse_picture_size(request.size);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  std::vector<View> views =
      request.turntable > 0
          ? turntable_views(bvh, request.camera, request.turntable, request.out, aspect)
          : choose_views(bvh, request.camera, request.out, aspect);
  check_in_view(bvh.scene(), bvh.bounds(), views, aspect);
  for (const View& view : views) {
    if (!is_video_path(request.out)) check_writable(view.out);
  }
  return views;
}

/// What there is to say about a picture that has been written.
nlohmann::json picture_json(const RenderRequest& request, const View& view,
                            const RenderSettings& settings, const Renderer& renderer,
                            const Frame& frame, double exposure) {
  nlohmann::json json = {{"out", view.out},
                         {"camera", nlohmann::json::parse(scene::camera_json(view.camera))},
                         {"exposure", exposure},
                         {"ev", request.exposure.ev},
                         {"background_pixels", frame.background},
                         {"metal_pixels", frame.metal_pixels},
                         {"passes", renderer.passes()},
                         {"path_passes", renderer.path_passes()}};
  if (settings.method == Method::Path) {
    json["paths"] = std::min<int64_t>(settings.max_samples,
                                      int64_t{renderer.path_passes()} * settings.path_samples);
  } else {
    json["gather_rays"] = renderer.passes() * settings.gather_rays;
    json["light_samples"] = renderer.passes() * settings.light_samples;
  }
  return json;
}

/// The keys of one picture stand beside those of the run; several are a list of their own.
nlohmann::json to_json(const RenderRequest& request, const Renderer& renderer, Method records,
                       const nlohmann::json& pictures, const StageSeconds& s, double total) {
  const auto [width, height] = parse_picture_size(request.size);
  nlohmann::json json = {
      {"scene", request.scene},
      {"output", request.output},
      {"integrator", request.integrator},
      {"quality", request.time.empty() && request.spp == 0 ? nlohmann::json(request.quality)
                                                           : nlohmann::json(nullptr)},
      {"precision", request.tool.precision},
      {"size", {width, height}},
      {"pruned_scene_points", renderer.pruned_points().pruned},
      {"left_out_lights", embed::names_of(renderer.bvh().scene(), renderer.culled_lights())},
      {"denoiser", renderer.denoised_by()},
      {"seconds", seconds_json(s, total)},
      {"peak_rss_mb", peak_rss_mb()}};
  if (!request.time.empty()) json["time"] = parse_time(request.time);
  if (renderer.has_cache()) {
    json["cache"] = {{"light", enum_name(records)},
                     {"records", renderer.cache().size()},
                     {"radius", renderer.cache().radius()}};
  }
  if (pictures.size() == 1) {
    json.update(pictures[0]);
    return json;
  }
  json["pictures"] = pictures;
  for (const nlohmann::json& picture : pictures) json["camera_list"].push_back(picture["camera"]);
  return json;
}

void print_exposure(const RenderRequest& request, const std::string& out, double exposure,
                    const char* end) {
  if (request.tool.common.quiet) return;
  std::printf("%s: exposure %.4g", out.c_str(), exposure);
  if (request.exposure.ev != 0) std::printf(" (ev %+g)", request.exposure.ev);
  std::fputs(end, stdout);
  std::fflush(stdout);
}

/// @throws lte::Error if an output would replace an input or another output
void claim_files(const RenderRequest& request, CommandFiles* files) {
  claim_light_files(request, files);
  files->reads("--camera", request.camera);
  claim_edits(request.edit, files);
  files->writes("--out", request.out);
  files->check();
}

/// The same of the files of several views, whose names are made from --out.
void claim_views(const RenderRequest& request, const std::vector<View>& views,
                 CommandFiles* files) {
  LTE_CHECK(
      views.size() > 1 || !is_video_path(request.out), request.out,
      ": a video needs several pictures: --turntable, --edit, or --camera with all or a list");
  for (const View& view : views) {
    if (view.out != request.out && !is_video_path(request.out)) files->writes("--out", view.out);
  }
  files->check();
}

/// The network if these pictures need one. Where it reads light that it has never seen, paths
/// trace the records of the cache, and `records` says so.
std::optional<runtime::Network> load_network(const RenderRequest& request,
                                             const std::vector<View>& views,
                                             const Renderer& renderer,
                                             const RenderSettings& settings, Method* records) {
  // An edit may bring light to a scene without any.
  const bool lit = renderer.needs_cache(settings) ||
                   (request.edit.any() && !render::is_geometry(settings.output) &&
                    settings.output != Output::Direct);
  const bool saves = !request.embedding.save.empty() && renderer.has_light();
  if (settings.method != Method::Network || !(lit || saves)) return std::nullopt;
  runtime::Network network(checkpoint_or_shipped(request.checkpoint),
                           network_options(request.tool));
  if (knows_light(request.embedding, renderer.bvh(), network,
                  embed_settings(request.embedding, request.seed, {}), cameras_of(views)))
    return network;
  *records = Method::Gather;
  return std::nullopt;
}

void embed(const RenderRequest& request, const std::vector<View>& views,
           const runtime::Network& network, const runtime::MemoryLimit& memory,
           Renderer* renderer) {
  EmbedSettings settings = embed_settings(request.embedding, request.seed, memory);
  const double search =
      cull_lights(request.embedding, renderer->bvh(), network, cameras_of(views), &settings);
  provide_embedding(request.embedding, network, settings, renderer);
  renderer->seconds().sample += search;
  memory.check("encoding the scene", {runtime::Hint::FewerScenePoints});
}

void check_cache_fits(const render::CacheSettings& settings, const scene::Scene& scene,
                      const runtime::MemoryLimit& memory) {
  memory.check_ahead(render::cache_mb(settings, static_cast<int64_t>(scene.light_groups.size())),
                     concat("an irradiance cache of ", settings.records, " records"),
                     "take fewer (--set records)");
}

/// What is on disk of the pictures of a pattern; nothing for a picture whose name was given.
std::optional<FrameSet> frames_of(const RenderRequest& request, const std::vector<View>& views,
                                  const scene::Scene& scene,
                                  const std::optional<runtime::Network>& network) {
  const bool named = views.front().out == request.out;
  if (request.validate_only || is_video_path(request.out)) return std::nullopt;
  LTE_CHECK(!named || !request.resume,
            "--resume goes with several pictures: --turntable, or --camera with a list or all");
  if (named) return std::nullopt;
  MadeWith settings = frame_settings(*request.flags, scene, network ? &*network : nullptr);
  if (request.edit.any()) {
    Checksum script;
    script.add(read_file(request.edit.script));
    settings["edits"] = script.text();
  }
  return FrameSet(request.out, std::move(settings));
}

/// The exposure of a picture; of the first one for all frames that share it.
/// @param of_video  the exposure that its pictures share, none before the first
float exposure_of(const RenderRequest& request, const Frame& frame, Output output,
                  std::optional<FrameSet>* frames, std::optional<double>* of_video) {
  ExposureOptions options = request.exposure;
  const bool shared =
      *frames && (request.exposure.first || request.turntable > 0 || request.edit.any());
  if (shared && !options.exposure)
    options.exposure = (*frames)->shared_exposure(double{frame_exposure(frame, output)});
  if (is_video_path(request.out) && !options.exposure) {
    if (!*of_video) *of_video = double{frame_exposure(frame, output)};
    options.exposure = *of_video;
  }
  return choose_exposure(frame, output, options);
}

/// What is left to do when the scene is encoded.
struct PictureRun {
  std::vector<View> views;
  RenderSettings settings;
  std::optional<FrameSet> frames;
  Method records = Method::Gather;  ///< what the cache's light is by
  EditedFrames* edited = nullptr;   ///< of --edit
  Timer total;
  Timer work;  ///< since loading was over
};

/// @param seconds  of the picture and what came before it, for one in a given time
LightCheck check_picture(const PictureRun& run, const View& view, const Frame& frame,
                         const Renderer& renderer, double seconds) {
  const StatePtr state = run.edited ? run.edited->state() : nullptr;
  const pathtrace::Bvh& bvh = state ? state->bvh() : renderer.bvh();
  const pathtrace::Lights& lights = state ? state->lights() : renderer.lights();
  CheckOptions options;
  options.max_paths = paths_to_check(int64_t{run.settings.width} * run.settings.height *
                                     renderer.passes() * run.settings.gather_rays);
  if (std::isfinite(run.settings.seconds))
    options.seconds = std::min(kCheckShare * seconds, run.settings.seconds - seconds);
  options.max_depth = run.settings.max_depth;
  options.seed = hash_combine(run.settings.seed, kCheckPaths);
  return check_light(
      bvh, lights,
      checked_pixels(bvh, view.camera, frame, hash_combine(run.settings.seed, kCheckedPlaces)),
      options);
}

void report(const RenderRequest& request, const View& view, const RenderSettings& settings,
            const Renderer& renderer, const Frame& frame) {
  report_metal(request.scene, settings, frame);
  if (frame.background == int64_t{settings.width} * settings.height &&
      !renderer.has_environment()) {
    log_warning(request.scene, ": camera ", view.camera.name,
                " sees no surface; the picture is black");
  } else if (renderer.has_light()) {
    report_darkness(request.scene, view.camera.name, settings.output, frame);
  }
}

void render_to_files(const RenderRequest& request, PictureRun run, Renderer* renderer) {
  StageSeconds seconds = renderer->seconds();
  nlohmann::json pictures = nlohmann::json::array();
  if (run.frames && !run.views.empty()) run.frames->write_manifest();
  const char* const end = run.views.size() > 1 ? "\n" : "";
  std::optional<Video> video;
  std::optional<double> of_video;
  if (is_video_path(request.out))
    video.emplace(request.out, run.settings.width, run.settings.height, request.fps);
  PictureWriter writer(
      [&](const FinishedPicture& picture) {
        print_exposure(request, picture.out.string(), picture.exposure, end);
      },
      video ? &*video : nullptr);
  // A given time is the picture's alone, and large pictures fit into memory once.
  const bool beside =
      request.time.empty() && int64_t{run.settings.width} * run.settings.height <= kMaxPixelsBeside;
  const bool checks = request.check && renderer->needs_cache(run.settings);
  for (const View& view : run.views) {
    RenderSettings settings = run.settings;
    settings.seconds -= run.work.seconds();
    Frame frame;
    nlohmann::json edit;
    {
      const PictureProgress progress(&settings);
      frame = run.edited ? run.edited->render(view, settings, &edit, &renderer->seconds())
                         : renderer->render(view.camera, settings);
    }
    LightCheck check;
    if (checks) check = check_picture(run, view, frame, *renderer, run.work.seconds());
    renderer->seconds().check = check.seconds;
    report(request, view, settings, *renderer, frame);
    report_check(view.out, run.records, check);
    const float exposure = exposure_of(request, frame, settings.output, &run.frames, &of_video);
    add_seconds(renderer->seconds(), &seconds);
    pictures.push_back(picture_json(request, view, settings, *renderer, frame, exposure));
    pictures.back()["check"] = check_json(check);
    if (run.edited) pictures.back()["edit"] = edit;
    writer.write({view.out, std::move(frame), settings.output, exposure, view.camera,
                  parse_enum<image::ToneCurve>("--set tone", request.exposure.tone)});
    if (!beside) writer.finish();
    run.work.restart();  // a view after the first has the time for itself
  }
  writer.finish();
  if (video) video->finish();
  seconds.write += writer.seconds();
  if (!request.tool.common.json.empty()) {
    const nlohmann::json json =
        to_json(request, *renderer, run.records, pictures, seconds, run.total.seconds());
    write_file(request.tool.common.json, json.dump(2) + '\n');
  }
  if (run.views.size() != 1 && !request.tool.common.quiet)
    std::printf("%zu pictures", run.views.size());
  if (!request.tool.common.quiet) print_times(seconds, run.total.seconds());
}

/// Checks of the command line that need no scene.
/// @param files  gets those that it names
void check_command(const RenderRequest& request, CommandFiles* files) {
  LTE_CHECK(!request.named_by_scene || !std::filesystem::exists(request.out), request.out,
            ": exists; name the picture in --out to replace it");
  claim_files(request, files);
  apply_tool_options(request.tool);
  check_writable(request.out);
  if (is_video_path(request.out)) {
    const auto [width, height] = parse_picture_size(request.size);
    check_video(request.out, width, height);
  }
  check_writable(request.tool.common.json);
  check_writable(request.embedding.save);
}

render::CacheSettings cache_settings(const RenderRequest& request, const RenderSettings& settings) {
  render::CacheSettings out = cache_settings(request);
  out.paths = record_paths(settings);
  out.seed = settings.seed;
  return out;
}

SessionSettings session_settings(const RenderRequest& request, const RenderSettings& settings,
                                 const runtime::MemoryLimit& memory, Method records) {
  SessionSettings out;
  out.embedding = embed_settings(request.embedding, request.seed, memory);
  const bool gathers = settings.method != Method::Path && !render::is_geometry(settings.output) &&
                       settings.output != Output::Direct;
  out.pictures = gathers ? records : Method::Path;
  out.cache = cache_settings(request, settings);
  return out;
}

}  // namespace

void run_render(const RenderRequest& request) {
  const RenderSettings settings = settings_of(request);
  CommandFiles files;
  check_command(request, &files);
  std::optional<EditScript> script;
  if (request.edit.any()) script = load_edit_script(request.edit.script);
  const runtime::MemoryLimit memory(request.tool.max_memory_mb);
  check_picture_fits(settings.width, settings.height, memory);
  const Timer total;
  const auto denoiser = std::make_shared<SharedDenoiser>();
  if (settings.denoise && !render::is_geometry(settings.output) && !request.validate_only)
    denoiser->prepare(settings.denoise_quality);
  const bool turns = request.turntable > 0 && request.camera.empty();  // from the automatic one on
  const scene::Scene scene = load_source(request, turns ? "auto" : request.camera);
  describe(scene, request.scene);
  Renderer renderer(std::make_shared<pathtrace::Bvh>(scene),
                    std::make_shared<pathtrace::Lights>(scene), denoiser);
  std::vector<View> views = views_of(request, renderer.bvh());
  if (script) views = edit_views(*script, scene, std::move(views), request.out);
  claim_views(request, views, &files);
  say_unit(request.scene, renderer.bvh());
  if (!renderer.has_light())
    log_warning(request.scene,
                ": nothing emits light; every output with light in it is black "
                "(--environment 1,1,1 or --add-light auto gives it some)");
  pathtrace::warn_of_lost_light(request.scene, renderer.bvh());
  Method records = settings.method;
  const render::CacheSettings cache = cache_settings(request, settings);
  const std::optional<runtime::Network> network =
      load_network(request, views, renderer, settings, &records);
  say_method(network ? checkpoint_or_shipped(request.checkpoint) : std::filesystem::path(),
             renderer, settings, records, cache.records);
  files.check_what_was_read();
  renderer.seconds().load = total.seconds();
  if (network) {
    check_size(request.scene, scene, *network, request.embedding.rescale);
    if (request.embedding.load.empty())
      memory.check_encoding(
          network->config(),
          embed::scene_point_count(renderer.bvh(), *network,
                                   embed_settings(request.embedding, request.seed, memory)));
  }
  const bool gathers = renderer.needs_cache(settings);
  if (gathers) check_cache_fits(cache, scene, memory);
  LTE_CHECK(network || !request.embedding.has_file(), request.embedding.load,
            request.embedding.save,
            ": this picture needs no embedding (--output, or a scene whose light the model does "
            "not know)");
  std::optional<FrameSet> frames = frames_of(request, views, scene, network);
  std::vector<View> all_views = views;
  if (request.validate_only) return print_valid_scene(scene, request.scene);
  if (frames) {
    files.writes("--out", frames->manifest());
    files.check();
    views = frames->missing(views, request.resume);
  }
  const Timer work;
  std::unique_ptr<EditedFrames> edited;
  if (script) {
    edited = std::make_unique<EditedFrames>(*script, all_views, scene, network,
                                            session_settings(request, settings, memory, records));
  } else {
    if (network && (!views.empty() || !request.embedding.save.empty()))
      embed(request, all_views, *network, memory, &renderer);
    if (gathers && !views.empty()) renderer.make_cache(records, cache);
  }
  render_to_files(
      request, {std::move(views), settings, std::move(frames), records, edited.get(), total, work},
      &renderer);
}

}  // namespace lte::infer
