#include "infer/eval/pictures_command.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "infer/eval/measure/pair_error.h"
#include "infer/eval/measure/reference_pair.h"
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

void check_size(const std::string& path, const image::Image& picture, const std::string& other,
                const image::Image& reference) {
  LTE_CHECK(picture.width == reference.width && picture.height == reference.height, path, ": is ",
            picture.width, "x", picture.height, ", and ", other, " is ", reference.width, "x",
            reference.height);
}

/// Root mean square over the mean, of an error that is free of the references' noise and at least
/// its standard error, and of the noise of one of them.
struct PairFigures {
  double error, noise;

  explicit PairFigures(const PairError& found)
      : error(std::sqrt(std::max(found.mse, found.mse_stderr)) / found.mean),
        noise(std::sqrt(found.path_variance) / found.mean) {}
};

}  // namespace

CLI::App* add_pictures_command(CLI::App& app, PicturesRequest* request) {
  CLI::App* command =
      app.add_subcommand("pictures", "Error of pictures (.exr) against a reference of them");
  command->fallthrough();
  command->add_option("pictures", request->pictures, "Pictures: .exr by lte_render")->required();
  command
      ->add_option("--reference", request->references,
                   "What they should be: .exr; twice where two of other seeds are at hand, whose "
                   "noise is then no error")
      ->required()
      ->allow_extra_args(false);
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
  LTE_CHECK(request.references.size() <= 2, "--reference: takes two files at most, got ",
            request.references.size());
  for (const std::string& path : request.references) files.reads("--reference", path);
  files.writes_common(common);
  files.check();
  apply_common_options(common);
  std::vector<image::Image> references;
  for (const std::string& path : request.references) {
    references.push_back(read_picture(path, request.layer));
    check_size(path, references.back(), request.references[0], references[0]);
  }
  const bool pair = references.size() == 2;
  const image::Image reference = pair ? mean_of_pair(references[0], references[1]) : references[0];
  nlohmann::json json = nlohmann::json::array();
  std::printf("%10s %10s %10s %10s %10s%s\n", "flip", "relmse", "mse", "ssim", "mean",
              pair ? "      error      noise" : "");
  for (const std::string& path : request.pictures) {
    const image::Image picture = read_picture(path, request.layer);
    check_size(path, picture, request.references[0], reference);
    const PictureScore score = score_picture(picture, reference);
    std::printf("%10.4f %10.4f %10.4g %10.4f %10.4f", score.flip, score.relmse, score.mse,
                score.ssim, score.mean);
    json.push_back({{"picture", path},
                    {"flip", score.flip},
                    {"relmse", score.relmse},
                    {"mse", score.mse},
                    {"ssim", score.ssim},
                    {"mean_ratio", score.mean}});
    if (pair) {
      const PairFigures found(pair_error(picture, references[0], references[1], {}, 1));
      std::printf(" %10.4f %10.4f", found.error, found.noise);
      json.back()["error"] = found.error;
      json.back()["noise"] = found.noise;
    }
    std::printf("  %s\n", path.c_str());
  }
  if (!common.json.empty()) write_file(common.json, json.dump(2) + "\n");
}

}  // namespace lte::infer
