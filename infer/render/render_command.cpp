#include "infer/render/render_command.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "infer/light/untrained_light.h"
#include "infer/render/edit_frames.h"
#include "infer/render/frame_io.h"
#include "infer/render/frame_set.h"
#include "infer/render/gather_plan.h"
#include "infer/render/incident_map.h"
#include "infer/render/notes.h"
#include "infer/render/picture_writer.h"
#include "infer/render/render_report.h"
#include "infer/render/scene_size.h"
#include "infer/render/time_budget.h"
#include "infer/render/unused_flags.h"
#include "infer/render/views.h"
#include "infer/renderer/check_report.h"
#include "infer/renderer/picture_memory.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/assets.h"
#include "infer/tool/picture_size.h"
#include "lte/base/checksum.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "lte/base/process_memory.h"
#include "lte/base/timer.h"
#include "lte/cli/command_files.h"
#include "lte/cli/writable.h"
#include "lte/pathtrace/reach/lost_light.h"
#include "lte/scene/light_points.h"
#include "lte/scene/load_camera.h"
#include "lte/scene/metal.h"

namespace lte::infer {
namespace {

/// Of a picture that is written while the next one is made.
constexpr int64_t kMostPixelsBeside = int64_t{1} << 20;

std::vector<View> views_of(const RenderRequest& request, const pathtrace::Bvh& bvh) {
  const auto [width, height] = parse_picture_size(request.size);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  std::vector<View> views =
      request.turntable > 0
          ? turntable_views(bvh, request.camera, request.turntable, request.out, aspect)
          : choose_views(bvh, request.camera, request.out, aspect);
  check_in_view(bvh.scene(), bvh.bounds(), views, aspect);
  for (const View& view : views) check_writable(view.out);
  return views;
}

nlohmann::json sparse_json(const RenderSettings& settings) {
  if (settings.indirect == Indirect::Gather && settings.gather.step > 1)
    return {{"step", settings.gather.step}};
  if (!settings.sparse) return false;
  const gi::SparseOptions& options = *settings.sparse;
  return {{"step", options.step},
          {"edge_step", options.edge_step},
          {"tolerance", options.tolerance},
          {"contact_radius", options.contact_radius}};
}

/// Counts that a pace has chosen are means.
nlohmann::json gather_json(const RenderSettings& settings, const Frame& frame) {
  if (settings.mode != Mode::Neural || settings.indirect != Indirect::Gather) return false;
  const PicturePace* pace = settings.gather.pace;
  return {
      {"rays", pace ? pace->mean_gather_rays() : double{1} * settings.gather.rays},
      {"correction_paths", settings.output == Output::Full ? frame.correction_paths
                                                           : double{1} * settings.correction_paths},
      {"pixels", frame.decoded}};
}

/// Shadow rays a pixel; a mean where a pace has chosen them.
double shadow_rays(const PicturePlan& plan) {
  if (plan.pace) return plan.pace->mean_rays();
  const double mean = plan.gather_pace ? plan.gather_pace->mean_shadow_rays() : 0;
  return mean > 0 ? mean : plan.settings.direct_samples;
}

/// What there is to say about a picture that has been written.
nlohmann::json picture_json(const RenderRequest& request, const View& view, const PicturePlan& plan,
                            TableLight table, const Frame& frame, double exposure) {
  const RenderSettings& settings = plan.settings;
  return {{"out", view.out},
          {"camera", nlohmann::json::parse(scene::camera_json(view.camera))},
          {"exposure", exposure},
          {"ev", request.exposure.ev},
          {"background_pixels", frame.background},
          {"queries", frame.queries},
          {"decoded_pixels", settings.indirect == Indirect::Gather  ? 0
                             : settings.sparse && frame.decoded > 0 ? frame.decoded
                                                                    : frame.queries},
          {"indirect", method_word(settings, table)},
          {"gather", gather_json(settings, frame)},
          {"correction_paths", frame.correction_paths},
          {"quality", enum_name(plan.quality)},
          {"sparse", sparse_json(settings)},
          {"antialias", settings.antialias},
          {"direct_samples", shadow_rays(plan)},
          {"edge_pixels", frame.edge_pixels},
          {"traced_pixels", frame.traced_pixels}};
}

/// The keys of one picture stand beside those of the run; several are a list of their own.
nlohmann::json to_json(const RenderRequest& request, const Renderer& renderer, TableLight table,
                       const nlohmann::json& pictures, const StageSeconds& s, double total) {
  const auto [width, height] = parse_picture_size(request.size);
  nlohmann::json json = {{"scene", request.scene},
                         {"output", request.output},
                         {"mode", request.mode},
                         {"precision", request.tool.precision},
                         {"size", {width, height}},
                         {"pruned_scene_points", renderer.pruned_points().pruned},
                         {"left_out_lights", names_of(renderer.bvh().scene(), renderer.left_out())},
                         {"denoiser", renderer.denoised_by()},
                         {"seconds", seconds_json(s, total)},
                         {"peak_rss_mb", peak_rss_mb()}};
  if (!request.time_budget.empty())
    json["time_budget_seconds"] = parse_time_budget(request.time_budget);
  if (renderer.has_table()) {
    json["table"] = {{"light", enum_name(table)},
                     {"entries", renderer.table().size()},
                     {"radius", renderer.table().radius()}};
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
  claim_scene(request, files);
  claim_embedding(request.embedding, files);
  files->reads("--checkpoint", request.checkpoint);
  files->reads("--camera", request.camera);
  claim_edits(request.edit, files);
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

/// The network if these pictures need one. Where it is told of light that it has never seen, paths
/// answer in its place, unless the flag says otherwise.
std::optional<runtime::Network> load_network(const RenderRequest& request,
                                             const std::vector<View>& views,
                                             const Renderer& renderer, RenderSettings* settings,
                                             TableSettings* table) {
  const PictureNeeds needs = renderer.needs(*settings);
  // An edit may bring light to a scene without any.
  const bool may_come = request.edit.any() && settings->mode == Mode::Neural &&
                        !is_geometry(settings->output) && settings->output != Output::Direct;
  const bool gathers = needs.table || (may_come && settings->indirect == Indirect::Gather);
  if (gathers && table->light == TableLight::Raw) return std::nullopt;
  const bool looks_inside = settings->output == Output::Attention;
  const scene::Scene& scene = renderer.bvh().scene();
  if (needs.network && needs.metal == Metal::Trace && !needs.reflects_by_network && !may_come &&
      !request.embedding.has_file() && scene::is_all_metal(scene)) {
    log_info("all surfaces are metal, which is path-traced: no model is needed");
    settings->indirect = Indirect::Paths;
    return std::nullopt;
  }
  if (!gathers && !needs.network && !may_come && !looks_inside) return std::nullopt;
  std::optional<runtime::Network> network(std::in_place, checkpoint_or_shipped(request.checkpoint),
                                          network_options(request.tool));
  if (looks_inside || !has_untrained_light(scene, network->metadata())) return network;
  const std::vector<int> left_out =
      left_out_light(request.embedding, renderer.bvh(), *network,
                     embed_settings(request.embedding, request.seed, {}), cameras_of(views));
  if (!has_untrained_light(scene, network->metadata(), left_out)) return network;
  if (request.untrained_light == "network") {
    log_warning(untrained_light_note(scene, network->metadata(), left_out));
    return network;
  }
  log_info(traced_light_note(scene, gathers ? table->paths : settings->spp, left_out));
  if (gathers) {
    table->light = TableLight::Raw;
  } else {
    settings->indirect = Indirect::Paths;
  }
  return std::nullopt;
}

int64_t scene_points(const RenderRequest& request, const runtime::Network& network) {
  return request.embedding.scene_points > 0 ? request.embedding.scene_points
                                            : network.metadata().scene_points;
}

void embed(const RenderRequest& request, const std::vector<View>& views,
           const runtime::Network& network, const runtime::MemoryLimit& memory,
           Renderer* renderer) {
  EmbedSettings settings = embed_settings(request.embedding, request.seed, memory);
  settings.record_attention = request.output == "attention";
  const double search = leave_out_unreached(request.embedding, renderer->bvh(), network,
                                            cameras_of(views), &settings);
  provide_embedding(request.embedding, network, settings, renderer);
  renderer->seconds().sample += search;
  memory.check("encoding the scene", {runtime::Remedy::FewerScenePoints});
}

void check_table_fits(const TableSettings& settings, const scene::Scene& scene,
                      const runtime::MemoryLimit& memory) {
  memory.check_ahead(table_mb(settings, static_cast<int64_t>(scene.light_groups.size())),
                     concat("a table of ", settings.entries, " points"),
                     "take fewer --table-points");
}

/// The switches of a picture: as the flags have them, or as the time that is left allows.
PicturePlan plan_of(const RenderRequest& request, const RenderSettings& base, const View& view,
                    const Timer& work, Renderer* renderer) {
  if (request.time_budget.empty())
    return {parse_enum<Quality>("--quality", request.quality), base, nullptr, nullptr};
  const double budget = parse_time_budget(request.time_budget);
  const auto sparse = parse_enum<Sparse>("--sparse", request.sparse);
  PicturePlan plan =
      renderer->needs(base).table
          ? plan_gathered(budget, work, sparse, request.given, base, view.camera, renderer)
          : plan_picture(budget, work, sparse, request.given, base, view.camera, renderer);
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
  FrameSettings settings = frame_settings(*request.flags, scene, network ? &*network : nullptr);
  if (request.edit.any()) {
    Checksum script;
    script.add(read_file(request.edit.script));
    settings["edits"] = script.text();
  }
  return FrameSet(request.out, std::move(settings));
}

/// The exposure of a picture; of the first one for all frames that share it.
float exposure_of(const RenderRequest& request, const Frame& frame, Output output,
                  std::optional<FrameSet>* frames) {
  ExposureOptions options = request.exposure;
  const bool shared =
      *frames && (request.one_exposure || request.turntable > 0 || request.edit.any());
  if (shared && !options.exposure)
    options.exposure = (*frames)->shared_exposure(double{frame_exposure(frame, output)});
  return choose_exposure(frame, output, options);
}

/// What is left to do when the scene is encoded.
struct PictureRun {
  std::vector<View> views;
  RenderSettings settings;  ///< but for what a time budget decides
  std::optional<FrameSet> frames;
  TableLight table = TableLight::Raw;  ///< of gathered light
  EditedFrames* edited = nullptr;      ///< of --edit
  std::optional<AttentionLook> look;   ///< of --output attention
  Timer total;
  Timer work;               ///< since the scene points were drawn
  bool by_network = false;  ///< the network answers, at pixels or in the table
};

/// @param before  seconds of work that the picture needs and that are over
void begin_check(const RenderRequest& request, double before, LightCheck* found,
                 RenderSettings* settings) {
  if (request.check == "off") return;
  settings->check = PictureCheck{found, before};
  if (!request.time_budget.empty())
    settings->check->budget_s = parse_time_budget(request.time_budget);
}

void render_to_files(const RenderRequest& request, PictureRun run, Renderer* renderer) {
  StageSeconds seconds = renderer->seconds();
  nlohmann::json pictures = nlohmann::json::array();
  if (run.frames && !run.views.empty()) run.frames->write_manifest();
  const char* const end = run.views.size() > 1 ? "\n" : "";
  PictureWriter writer([&](const FinishedPicture& picture) {
    print_exposure(request, picture.out.string(), picture.exposure, end);
  });
  // The time of a budget is the picture's alone, and large pictures fit into memory once.
  const bool beside = request.time_budget.empty() && !run.views.empty() &&
                      int64_t{run.settings.width} * run.settings.height <= kMostPixelsBeside;
  int64_t traced_pixels = 0;
  for (const View& view : run.views) {
    PicturePlan plan = plan_of(request, run.settings, view, run.work, renderer);
    RenderSettings& settings = plan.settings;
    LightCheck check;
    begin_check(request, run.work.seconds(), &check, &settings);
    Frame frame;
    nlohmann::json edit;
    {
      const PictureProgress progress(&settings);
      frame = run.edited ? run.edited->render(view, settings, &edit, &renderer->seconds())
                         : renderer->render(view.camera, settings);
    }
    if (run.look) run.look->paint(view.camera, &frame);
    report_metal(request.scene, settings, frame);
    traced_pixels += frame.traced_pixels;
    report_check(view.out, run.by_network, check);
    if (frame.background == int64_t{settings.width} * settings.height &&
        !renderer->has_environment()) {
      log_warning(request.scene, ": camera ", view.camera.name,
                  " sees no surface; the picture is black");
    } else if (renderer->has_light()) {
      report_darkness(request.scene, view.camera.name, settings.output, frame);
    }
    const float exposure = exposure_of(request, frame, settings.output, &run.frames);
    add_seconds(renderer->seconds(), &seconds);
    if (run.edited) seconds.table += renderer->seconds().table;  // each frame has one of its own
    pictures.push_back(picture_json(request, view, plan, run.table, frame, exposure));
    pictures.back()["check"] = check_json(check);
    if (run.edited) pictures.back()["edit"] = edit;
    if (run.look) pictures.back()["attention"] = run.look->json();
    writer.write({view.out, std::move(frame), settings.output, exposure, view.camera,
                  parse_enum<image::ToneCurve>("--tone", request.exposure.tone)});
    if (!beside) writer.finish();
    run.work.restart();  // a view after the first has the budget for itself
  }
  writer.finish();
  if (!run.views.empty()) note_unused_paths(request, traced_pixels);
  seconds.write += writer.seconds();
  if (!request.tool.common.json.empty()) {
    const nlohmann::json json =
        to_json(request, *renderer, run.table, pictures, seconds, run.total.seconds());
    write_file(request.tool.common.json, json.dump(2) + '\n');
  }
  if (run.views.size() != 1 && !request.tool.common.quiet)
    std::printf("%zu pictures", run.views.size());
  if (!request.tool.common.quiet) print_times(seconds, run.total.seconds());
}

}  // namespace

void run_render(const RenderRequest& request) {
  if (request.output == "incident") return run_incident_map(request);
  LTE_CHECK(!request.named_by_scene || !std::filesystem::exists(request.out), request.out,
            ": exists; name the picture in --out to replace it");
  check_dial(request);
  check_edit_flags(request.edit, request.out);
  check_attention_flags(request);
  check_draws(request.embedding);
  const IndirectMethod method = indirect_method(request.gather);
  LTE_CHECK(
      !request.edit.any() || method == IndirectMethod::Gather || method == IndirectMethod::Decoded,
      "--edit and --indirect ", request.gather.method, ": expected gather or decoded");
  CommandFiles files;
  claim_files(request, &files);
  apply_tool_options(request.tool);
  note_unused_flags(request);
  check_writable(request.out);
  check_writable(request.tool.common.json);
  check_writable(request.embedding.save);
  check_writable(request.edit.video);
  check_writable(request.edit.save_scene);
  std::optional<EditScript> script;
  if (request.edit.any()) script = load_edit_script(request.edit.script);
  RenderSettings settings = settings_of(request);
  check_picture_fits(settings, available_memory_mb());
  const Timer total;
  const bool turns = request.turntable > 0 && request.camera.empty();  // from the automatic one on
  const auto denoiser = std::make_shared<SharedDenoiser>();
  if (settings.mode == Mode::Neural && settings.indirect == Indirect::Gather &&
      settings.denoise != Denoise::Off && !request.validate_only) {
    denoiser->prepare(settings.gather.quality);
  }
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
  TableSettings table = table_settings(request.gather, settings.max_depth, settings.seed);
  const std::optional<runtime::Network> network =
      load_network(request, views, renderer, &settings, &table);
  say_method(checkpoint_or_shipped(request.checkpoint), renderer, settings, table);
  files.check_what_was_read();
  renderer.seconds().load = total.seconds();
  const runtime::MemoryLimit memory(request.tool.max_memory_mb);
  LTE_CHECK(
      !network || settings.metal != Metal::Network || network->config().predicts_radiance(),
      checkpoint_or_shipped(request.checkpoint).string(),
      ": has no radiance decoder, which --metal network asks (its model.radiance_lobes is 0)");
  if (network) {
    check_size(request.scene, scene, *network, request.embedding.rescale);
    if (request.embedding.load.empty())
      memory.check_encoding(network->config(), scene_points(request, *network));
  }
  const bool gathers = renderer.needs(settings).table;
  settings.keep_light = gathers && views.size() > 1 && request.gather.keep_light == "on";
  if (gathers) check_table_fits(table, scene, memory);
  check_picture_fits(settings, memory);
  LTE_CHECK(
      network || !request.embedding.has_file(), request.embedding.load, request.embedding.save,
      ": this picture needs no embedding (--mode, --output, --indirect, or a scene without light)");
  std::optional<FrameSet> frames = frames_of(request, views, scene, network);
  std::vector<View> all_views = views;
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
  std::unique_ptr<EditedFrames> edited;
  if (script) {
    edited = std::make_unique<EditedFrames>(
        *script, all_views, scene, network,
        SessionSettings{embed_settings(request.embedding, request.seed, memory),
                        request.untrained_light == "network"},
        table);
    check_picture_fits(settings, memory);
  }
  if (network && !script && (!views.empty() || !request.embedding.save.empty())) {
    embed(request, all_views, *network, memory, &renderer);
    check_picture_fits(settings, memory);
  }
  if (gathers && !views.empty() && !script) {
    check_table_fits(table, scene, memory);
    renderer.make_table(table);
  }
  std::optional<AttentionLook> look;
  if (settings.output == Output::Attention && !views.empty()) {
    look.emplace(request.attention, Vec3{request.point[0], request.point[1], request.point[2]},
                 renderer.bvh(), renderer.shared_embedding(), all_views.front().camera.origin);
    log_info(look->text());
  }
  render_to_files(
      request,
      {std::move(views), settings, std::move(frames), table.light, edited.get(), std::move(look),
       total, work, settings.indirect == Indirect::Decoded || table.light == TableLight::Network},
      &renderer);
  if (edited) edited->finish(request.edit, request.out);
}

}  // namespace lte::infer
