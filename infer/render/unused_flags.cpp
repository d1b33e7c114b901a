#include "infer/render/unused_flags.h"

#include <array>

#include "infer/render/frame_io.h"
#include "lte/base/log.h"

namespace lte::infer {
namespace {

struct UnusedFlag {
  const char* name;
  const char* why;
};

constexpr std::array<UnusedFlag, 11> kUnusedByReference{{
    {"--quality", "a reference takes --spp paths a pixel"},
    {"--sparse", "a reference asks every pixel"},
    {"--direct-samples", "a reference takes --spp paths a pixel"},
    {"--adaptive-direct", "a reference takes --spp paths a pixel"},
    {"--metal", "a reference shows metal as it is"},
    {"--reflections", "a reference shows metal as it is"},
    {"--untrained-light", "a reference needs no model"},
    {"--checkpoint", "a reference needs no model"},
    {"--scene-points", "a reference needs no model"},
    {"--prune", "a reference needs no model"},
    {"--draws", "a reference needs no model"},
}};

bool given(const RenderRequest& request, const char* name) {
  const CLI::Option* const option = request.flags->get_option_no_throw(name);
  return option != nullptr && option->count() > 0;
}

}  // namespace

void note_unused_flags(const RenderRequest& request) {
  if (request.mode == "reference") {
    for (const UnusedFlag& flag : kUnusedByReference)
      if (given(request, flag.name)) log_warning(flag.name, " is ignored: ", flag.why);
    if (request.output == "full" && given(request, "--aa"))
      log_warning("--aa is ignored: the paths of a full reference are spread over the pixel");
    return;
  }
  if (given(request, "--reflections") && request.metal != "network")
    log_warning("--reflections is ignored: it goes with --metal network");
  if (request.exposure.tone != "linear" && keeps_layers(request.out))
    log_warning("--tone is ignored: an .exr is linear");
}

void note_unused_paths(const RenderRequest& request, int64_t traced_pixels) {
  if (request.mode != "neural" || traced_pixels > 0 || !given(request, "--spp")) return;
  log_warning(
      "--spp ", request.spp,
      " is ignored: no pixel here needed paths of its own, as metal does; --direct-samples sets "
      "the rays for direct light, --correction-paths the paths that correct a picture, and --mode "
      "reference path-traces all of it");
}

}  // namespace lte::infer
