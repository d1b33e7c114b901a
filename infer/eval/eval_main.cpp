// lte_eval: error of a model on scenes with ground truth, beside cheap predictors.
#include <iostream>

#include "infer/eval/eval_command.h"
#include "infer/eval/flicker_command.h"
#include "infer/eval/pictures_command.h"
#include "infer/eval/scenes_command.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Measures a model's error on baked scenes, beside path tracing and cheap predictors.",
      "lte_eval"};
  app.footer(
      "Examples:\n"
      "  lte_eval --split test\n"
      "  lte_eval --checkpoint run/model.safetensors --data homes --split test --report report "
      "--json eval.json\n"
      "  lte_eval --fit-baselines homes --out run/model.baselines.json\n"
      "  lte_eval flicker frames/*.exr --reference reference/*.exr\n"
      "  lte_eval scenes assets/scenes --report out/scenes");
  lte::infer::EvalRequest request;
  lte::infer::add_eval_options(app, &request);
  lte::infer::FlickerRequest flicker;
  const CLI::App* flicker_command = lte::infer::add_flicker_command(app, &flicker);
  lte::infer::PicturesRequest pictures;
  const CLI::App* pictures_command = lte::infer::add_pictures_command(app, &pictures);
  lte::infer::ScenesRequest scenes;
  const CLI::App* scenes_command = lte::infer::add_scenes_command(app, &scenes);
  return lte::infer::run_network_tool(app, argc, argv, [&] {
    if (app.got_subcommand(flicker_command)) return run_flicker(flicker, request.tool.common);
    if (app.got_subcommand(pictures_command)) return run_pictures(pictures, request.tool.common);
    if (app.got_subcommand(scenes_command)) return run_scenes(scenes, request.tool);
    lte::infer::read_run_config(&request);
    if (request.tool.print_config) {
      std::cout << lte::config_text(app);
    } else {
      lte::infer::run_eval(request);
    }
  });
}
