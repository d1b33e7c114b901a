#include "infer/render/render_request.h"

#include <cmath>
#include <filesystem>
#include <tuple>

#include "infer/render/frame_io.h"
#include "infer/render/help_groups.h"
#include "infer/render/video.h"
#include "infer/renderer/quality.h"
#include "infer/tool/picture_size.h"
#include "lte/base/check.h"
#include "lte/cli/numbers.h"
#include "lte/scene/load_camera.h"

namespace lte::infer {
namespace {

std::string check_picture_name(const std::string& path) {
  if (is_picture_path(path) || is_video_path(path)) return "";
  return concat("\"", path,
                "\" ends neither in .exr or .png nor, for a video, in .mp4, .webm or .gif");
}

/// The picture of a command line without --out: named after the scene, in the working folder.
std::string default_picture(const RenderRequest& r) {
  const bool several = r.turntable > 0 || r.edit.any() || r.camera == "all";
  return std::filesystem::path(r.scene).stem().string() + (several ? "_%02d.png" : ".png");
}

void add_picture_options(CLI::App& app, RenderRequest* r) {
  app.add_option("scene", r->scene, "Scene to render: .gltf, .glb, .pbrt, .obj or .ply")
      ->required();
  app.add_option("--out", r->out,
                 "Picture to write: .exr (linear, with layers) or .png; with several cameras a "
                 "pattern, %d or %04d for the number and {name} for the camera's name. By default "
                 "SCENE's name with .png in the working folder, where nothing may have that name")
      ->check(CLI::Validator(check_picture_name, "FILE.exr|FILE.png"));
  app.add_option("--size", r->size, "Picture size")
      ->check(CLI::Validator(check_picture_size, "WxH"))
      ->capture_default_str();
  app.add_option("--output", r->output,
                 "What to show; gi is reflected indirect light, irradiance is it untextured")
      ->check(CLI::IsMember({"full", "gi", "irradiance", "direct", "albedo", "normal", "depth"}))
      ->capture_default_str();
  app.add_flag("--validate-only", r->validate_only,
               "Check scene, camera and flags, and write nothing");
  app.add_option("--camera", r->camera,
                 concat(scene::kCameraHelp, "; by default the scene's first camera, else auto"));
  app.add_option("--turntable", r->turntable,
                 "So many cameras that turn around the scene, or in place inside a room, from the "
                 "one of --camera (by default auto) on; --out is a pattern or a video")
      ->check(CLI::Range(1, 100'000));
  add_edit_flags(app, &r->edit);
  app.add_flag("--resume", r->resume,
               "Several pictures: keep those that exist and make the rest, if they were made with "
               "the same settings; without it a picture that exists is an error");
}

void add_light_options(CLI::App& app, RenderRequest* r) {
  add_light_flags(app, "each pixel", r);
  CLI::Option* const quality =
      app.add_option("--quality", r->quality,
                     "How long it takes: draft (one pass of 4 rays a pixel), preview (one of 16, 4 "
                     "in large pictures) or final (16 passes, with paths that correct gathered "
                     "light)")
          ->check(CLI::IsMember({"draft", "preview", "final"}))
          ->capture_default_str();
  CLI::Option* const time =
      app.add_option("--time", r->time,
                     "Passes until such a time is over, as 0.5s or 200ms: cache, encoding and "
                     "denoising included, reading the scene and writing the picture not")
          ->check(a_time())
          ->excludes(quality);
  app.add_option("--spp", r->spp, "With --integrator path: so many paths a pixel")
      ->check(CLI::Range(1, 1 << 24))
      ->excludes(quality)
      ->excludes(time);
  add_embedding_flags(app, &r->embedding);
  app.get_option("--edit")->excludes("--embedding")->excludes("--save-embedding");
}

void add_keys(RenderRequest* r) {
  SetKeys& keys = r->keys;
  RenderSettings& s = r->settings;
  keys.add("denoise", &s.denoise,
           "take noise out, by Open Image Denoise where it is found ($LTE_OIDN), else by a filter "
           "of lte's");
  add_light_keys("the first one that the camera sees", r);
  keys.add("gather_rays", &s.gather_rays, 1, 1 << 14,
           "of gather and network: rays a pixel, a pass");
  keys.add("light_samples", &s.light_samples, 1, 1 << 14,
           "of gather and network: samples of direct light a pixel, a pass");
  keys.add("correct", &s.correct,
           "of gather and network: paths correct what they say, from the ninth pass on");
  keys.add("check", &r->check,
           "of gather and network: hold the indirect light to account by a few thousand paths, and "
           "warn where it is off by more than they explain");
  add_exposure_keys(&keys, &r->exposure);
  keys.add("fps", &r->fps, 1, 240, "of a video: pictures a second");
}

/// Whatever is given has an effect.
void check_used(const RenderRequest& r, Output output) {
  if (render::is_geometry(output)) {
    const char* const flag =
        first_given(*r.flags, {"--integrator", "--quality", "--time", "--spp"});
    LTE_CHECK(flag == nullptr, flag, " goes with a picture of light, not --output ", r.output);
  }
  check_light_used(r, {"gather_rays", "light_samples", "records", "correct", "check"});
  LTE_CHECK(r.spp == 0 || r.by_paths(),
            "--spp goes with --integrator path: gather and network take --quality or --time");
  LTE_CHECK(!r.keys.is_given("fps") || is_video_path(r.out),
            "--set fps goes with a video: --out turn.mp4, .webm or .gif");
  LTE_CHECK(!r.resume || !is_video_path(r.out),
            "--resume goes with pictures: a video is made in one go");
  const bool png = !keeps_layers(r.out);
  const char* const shown = first_set(r.keys, {"exposure", "ev", "tone"});
  LTE_CHECK(shown == nullptr || png || r.out.empty(), "--set ", shown,
            " goes with a .png: an .exr has linear light");
}

}  // namespace

RenderSettings settings_of(const RenderRequest& request) {
  RenderSettings settings = request.settings;
  settings.output = parse_enum<Output>("--output", request.output);
  settings.method = parse_enum<Method>("--integrator", request.integrator);
  settings.max_depth = request.max_depth;
  check_used(request, settings.output);
  std::tie(settings.width, settings.height) = parse_picture_size(request.size);
  settings.seed = request.seed;
  settings.layers = keeps_layers(request.out);
  settings = with_quality(parse_enum<Quality>("--quality", request.quality), settings);
  if (!request.time.empty()) settings = with_time(parse_time(request.time), settings);
  if (request.spp > 0) settings = with_paths(request.spp, settings);
  return settings;
}

void add_render_options(CLI::App& app, RenderRequest* r) {
  add_picture_options(app, r);
  add_light_options(app, r);
  add_keys(r);
  add_tool_flags(app, r);
  app.parse_complete_callback([r] {
    r->keys.read();
    if (!r->out.empty() || r->validate_only) return;
    r->out = default_picture(*r);
    r->named_by_scene = true;
  });
  group_render_flags(&app);
}

}  // namespace lte::infer
