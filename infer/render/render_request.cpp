#include "infer/render/render_request.h"

#include <charconv>
#include <filesystem>
#include <tuple>

#include "infer/render/frame_io.h"
#include "infer/render/help_groups.h"
#include "infer/render/time_budget.h"
#include "infer/tool/picture_size.h"
#include "lte/base/check.h"
#include "lte/cli/numbers.h"
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

/// The picture of a command line without --out: named after the scene, in the working folder.
std::string default_picture(const RenderRequest& r) {
  const bool several = r.turntable > 0 || r.edit.any() || r.camera == "all";
  return std::filesystem::path(r.scene).stem().string() + (several ? "_%02d.png" : ".png");
}

/// Which flags win over the quality, and where the picture goes.
void note_given(const CLI::App& app, RenderRequest* r) {
  if (r->out.empty() && (!r->validate_only || r->output == "incident")) {
    r->out = default_picture(*r);
    r->named_by_scene = true;
  }
  r->given.direct_samples = app.count("--direct-samples") > 0;
  r->given.antialias = app.count("--aa") > 0;
  r->given.sparse = app.count("--sparse") > 0;
  r->given.gather_rays = r->gather.rays != 0;
  r->given.correction_paths = r->gather.paths >= 0;
}

}  // namespace

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
  settings.reflections = request.reflections;
  settings.layers = keeps_layers(request.out) || settings.output == Output::Attention;
  // A picture of what the network attends to is painted on what it decodes.
  settings.indirect =
      settings.output == Output::Attention ? Indirect::Decoded : indirect_of(request.gather);
  if (request.given.gather_rays) settings.gather.rays = request.gather.rays;
  if (request.given.correction_paths) settings.correction_paths = request.gather.paths;
  return with_quality(parse_enum<Quality>("--quality", request.quality),
                      parse_enum<Sparse>("--sparse", request.sparse), request.given, settings);
}

void check_dial(const RenderRequest& request) {
  const IndirectMethod method = indirect_method(request.gather);
  check_gather_flags(*request.flags, request.gather, request.mode == "neural",
                     request.output == "attention");
  LTE_CHECK(request.time_budget.empty() || request.mode == "neural",
            "--time-budget needs --mode neural: a reference takes --spp paths a pixel");
  LTE_CHECK(request.gather.paths <= 0 || method != IndirectMethod::Decoded ||
                (request.output == "full" && request.time_budget.empty()),
            "--correction-paths with --indirect decoded needs --output full, and goes with no "
            "--time-budget");
  LTE_CHECK(
      request.metal != "network" ||
          (request.mode == "neural" && method == IndirectMethod::Decoded && !request.edit.any()),
      "--metal network needs --mode neural and --indirect decoded, and goes with no --edit");
  LTE_CHECK(request.sparse != "on" || request.mode == "neural",
            "--sparse on needs --mode neural: a reference asks every pixel");
}

void add_render_options(CLI::App& app, RenderRequest* r) {
  r->flags = &app;
  app.add_option("scene", r->scene, "Scene to render: .gltf, .glb, .pbrt, .obj or .ply")
      ->required();
  app.add_option("--out", r->out,
                 "Picture to write: .exr (linear, with layers) or .png; with several cameras a "
                 "pattern, %d or %04d for the number and {name} for the camera's name. By default "
                 "SCENE's name with .png in the working folder, where nothing may have that name")
      ->check(CLI::Validator(check_picture, "FILE.exr|FILE.png"));
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
  app.add_option(
         "--output", r->output,
         "What to show; gi is reflected indirect light, irradiance is it untextured, "
         "attention what the network looks at for --point, incident is radiance by direction "
         "at --point, the network's beside the traced")
      ->check(CLI::IsMember({"full", "gi", "irradiance", "direct", "albedo", "normal", "depth",
                             "attention", "incident"}))
      ->capture_default_str();
  app.add_option("--point", r->point,
                 "Of --output attention and incident: a place in metres, of which the nearest "
                 "surface point is shown")
      ->delimiter(',')
      ->expected(3)
      ->type_name("X,Y,Z");
  app.add_option("--mode", r->mode,
                 "Indirect light as --indirect says, or the path-traced reference of the same "
                 "quantity")
      ->check(CLI::IsMember({"neural", "reference"}))
      ->capture_default_str();
  app.add_option(
         "--quality", r->quality,
         "Neural mode, how long a picture takes, flags by hand win: draft (8 gather rays at "
         "a quarter of the pixels), preview (16 of them) or final (32 rays at each pixel, "
         "corrected by paths); docs/pictures.md has what is decoded")
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
  app.parse_complete_callback([&app, r] { note_given(app, r); });
  app.add_option(
         "--aa", r->antialias,
         "Hits a pixel at edges, which share the answers of pixels; or off. A full reference "
         "spreads its paths over the pixel instead")
      ->check(CLI::Validator(check_antialias, "off|N"))
      ->capture_default_str();
  app.add_option("--metal", r->metal,
                 "Neural mode: what stands for metal: paths (--spp a pixel), a matt surface of its "
                 "color, black, or network: paths for direct light, and a model with a radiance "
                 "decoder for what has bounced")
      ->check(CLI::IsMember({"diffuse", "black", "trace", "network"}))
      ->capture_default_str();
  app.add_option("--reflections", r->reflections,
                 "Of --metal network: directions a pixel that radiance is asked from")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--untrained-light", r->untrained_light,
                 "Neural mode: who answers for indirect light in a scene with directional lights "
                 "or an environment if the model was trained without any: paths (--spp a pixel), "
                 "or the network, wrongly")
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
  add_gather_options(app, &r->gather);
  app.add_option("--checkpoint", r->checkpoint, "Model; by default the shipped one");
  app.add_option("--check", r->check,
                 "Neural mode: hold the indirect light to account by a few thousand paths, and "
                 "warn where it is off by more than they explain")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  add_embedding_flags(app, &r->embedding);
  add_edit_flags(app, &r->edit);
  add_attention_flags(app, &r->attention);
  add_exposure_options(app, &r->exposure);
  app.add_flag("--one-exposure", r->one_exposure,
               "Several pictures: all take the exposure of the first, as with --turntable");
  app.add_option("--seed", r->seed, "Seed of scene points and light samples")
      ->capture_default_str();
  app.add_flag("--validate-only", r->validate_only,
               "Check scene, camera and flags, and write nothing");
  add_scene_options(app, r);
  add_tool_options(app, &r->tool);
  group_render_flags(&app);
}

}  // namespace lte::infer
