#include "infer/eval/pictures_command.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "infer/picture/picture_score.h"
#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/cli/command_files.h"
#include "lte/image/exr.h"

namespace lte::infer {
namespace {

image::Image read_picture(const std::string& path, const std::string& layer) {
  image::Image picture = image::read_exr(path, layer);
  LTE_CHECK(picture.channels == 3, path, ": layer \"", layer, "\" has no color");
  return picture;
}

}  // namespace

CLI::App* add_pictures_command(CLI::App& app, PicturesRequest* request) {
  CLI::App* command =
      app.add_subcommand("pictures", "Error of pictures (.exr) against a reference of them");
  command->fallthrough();
  command->add_option("pictures", request->pictures, "Pictures: .exr by lte_render")->required();
  command->add_option("--reference", request->reference, "What they should be: .exr")->required();
  command->add_option("--layer", request->layer,
                      "What to compare: a layer such as indirect; by default the picture");
  command->footer(
      "Example:\n"
      "  lte_render room.glb --integrator path --spp 1024 --set denoise=off --out reference.exr\n"
      "  lte_render room.glb --out gathered.exr\n"
      "  lte_eval pictures gathered.exr --reference reference.exr");
  return command;
}

void run_pictures(const PicturesRequest& request, const CommonOptions& common) {
  CommandFiles files;
  for (const std::string& path : request.pictures) files.reads("PICTURES", path);
  files.reads("--reference", request.reference);
  files.writes_common(common);
  files.check();
  apply_common_options(common);
  const image::Image reference = read_picture(request.reference, request.layer);
  nlohmann::json json = nlohmann::json::array();
  std::printf("%10s %10s %10s %10s %10s\n", "flip", "relmse", "mse", "ssim", "mean");
  for (const std::string& path : request.pictures) {
    const image::Image picture = read_picture(path, request.layer);
    LTE_CHECK(picture.width == reference.width && picture.height == reference.height, path, ": is ",
              picture.width, "x", picture.height, ", and ", request.reference, " is ",
              reference.width, "x", reference.height);
    const PictureScore score = score_picture(picture, reference);
    std::printf("%10.4f %10.4f %10.4g %10.4f %10.4f  %s\n", score.flip, score.relmse, score.mse,
                score.ssim, score.mean, path.c_str());
    json.push_back({{"picture", path},
                    {"flip", score.flip},
                    {"relmse", score.relmse},
                    {"mse", score.mse},
                    {"ssim", score.ssim},
                    {"mean_ratio", score.mean}});
  }
  if (!common.json.empty()) write_file(common.json, json.dump(2) + "\n");
}

}  // namespace lte::infer
