#include "infer/render/edit_flags.h"

#include "infer/render/frame_io.h"
#include "infer/render/video.h"
#include "lte/base/check.h"

namespace lte::infer {
namespace {

std::string check_video(const std::string& path) {
  return is_video_path(path) ? ""
                             : concat("\"", path, "\" ends in none of .mp4, .webm, .mkv and .gif");
}

std::string check_glb(const std::string& path) {
  return path.ends_with(".glb") ? "" : concat("\"", path, "\" does not end in .glb");
}

}  // namespace

void add_edit_flags(CLI::App& app, EditFlags* flags) {
  CLI::Option* script =
      app.add_option("--edit", flags->script,
                     "Pictures of a scene that changes: a YAML file of edits with frames "
                     "(docs/editing.md); --out is a pattern, and all pictures share one exposure")
          ->check(CLI::ExistingFile)
          ->excludes("--time-budget")
          ->excludes("--embedding")
          ->excludes("--save-embedding")
          ->excludes("--draws");
  app.add_option("--video", flags->video,
                 "With --edit: also make a video of the frames (.mp4, .webm, .mkv or .gif), where "
                 "ffmpeg is found")
      ->check(CLI::Validator(check_video, "FILE.mp4"))
      ->needs(script);
  app.add_option("--save-scene", flags->save_scene,
                 "With --edit: also write the scene as it is in the last frame")
      ->check(CLI::Validator(check_glb, "FILE.glb"))
      ->needs(script);
}

void check_edit_flags(const EditFlags& flags, const std::string& out) {
  LTE_CHECK(flags.video.empty() || (!keeps_layers(out) && out.find("{name}") == std::string::npos),
            "--video needs frames in .png with %d or %04d for their number, got --out ", out);
}

void claim_edits(const EditFlags& flags, CommandFiles* files) {
  files->reads("--edit", flags.script);
  files->writes("--video", flags.video);
  files->writes("--save-scene", flags.save_scene);
}

}  // namespace lte::infer
