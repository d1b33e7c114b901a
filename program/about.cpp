#include "program/about.h"

#include "lte/base/parallel.h"
#include "lte/base/version.h"
#include "lte/cli/assets.h"
#include "lte/image/denoise.h"
#include "lte/ops/cpu/kernels/kernels.h"
#include "lte/scene/load.h"

namespace lte {

nlohmann::ordered_json about(const TorchTools& torch) {
  nlohmann::ordered_json out = {{"version", version()},
                                {"instruction_set", ops::cpu_isa()},
                                {"threads", num_threads()},
                                {"scenes", scene::scene_formats()},
                                {"pictures", {".png", ".exr"}}};
  out["models"] = nlohmann::ordered_json::object();
  for (const auto& [name, file] : shipped_models()) out["models"][name] = file.string();
  out["denoiser"] = image::Denoiser().description();
  out["torch"] = nullptr;
  if (!torch.program.empty()) out["torch"] = torch.program;
  return out;
}

}  // namespace lte
