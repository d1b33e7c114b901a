#include "train/loop/session_log.h"

#include <algorithm>
#include <cmath>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/process_memory.h"
#include "train/optim/schedule.h"

namespace lte::train {

SessionLog::SessionLog(const TrainConfig& config, const RunProgress& progress,
                       const std::optional<std::string>& saved)
    : config_(config.train),
      log_(std::filesystem::path(config.output) / "log.jsonl", progress.step, saved) {
  log_.add_events(std::filesystem::path(config.output) / "tensorboard", progress.step);
}

bool SessionLog::writes_at(int64_t step) const {
  return step % config_.log_every == 0 || step == config_.steps;
}

void SessionLog::write_step(RunProgress* progress, double norm, const ModuleGradients& modules,
                            double waited_seconds) {
  NamedValues fields = {
      {"loss", progress->window_loss / static_cast<double>(progress->window_steps)},
      {"lr", learning_rate(config_, progress->step - 1)},
      {"grad_norm", norm},
      {"queries_per_s", static_cast<double>(window_queries_) / window_timer_.seconds()},
      {"seconds", progress->seconds},
      {"wait_share", (waited_seconds - waited_before_) / window_timer_.seconds()},
      {"rss_mb", current_rss_mb()}};
  for (const auto& [module, value] : modules.norms)
    fields.emplace_back(concat(kModuleNormPrefix, module), value);
  for (const auto& [module, value] : modules.rms)
    fields.emplace_back(concat(kModuleRmsPrefix, module), value);
  log_.write(progress->step, fields);
  waited_before_ = waited_seconds;
  window_queries_ = 0;
  progress->window_loss = 0;
  progress->window_steps = 0;
  window_timer_.restart();
}

void SessionLog::write_validation(int64_t step, const ValidationResult& result, double seconds,
                                  const NamedValues& health) {
  NamedValues fields = result.fields();
  fields.emplace_back("val_seconds", seconds);
  fields.insert(fields.end(), health.begin(), health.end());
  log_.write(step, fields, result.scenes);
}

NamedValues health_fields(const std::vector<nn::StageHealth>& stages, const NamedValues& moved) {
  NamedValues fields;
  for (const nn::StageHealth& stage : stages) {
    fields.emplace_back(concat(kHealthPrefix, "rms_", stage.stage), stage.rms);
    fields.emplace_back(concat(kHealthPrefix, "varying_", stage.stage), stage.varying);
    if (!std::isnan(stage.entropy))
      fields.emplace_back(concat(kHealthPrefix, "entropy_", stage.stage), stage.entropy);
  }
  for (const auto& [module, value] : moved)
    fields.emplace_back(concat(kHealthPrefix, "moved_", module), value);
  return fields;
}

void SessionLog::add_pictures(int64_t step, const std::vector<PreviewPicture>& pictures) {
  if (!log_.events()) return;
  for (size_t i = 0; i < std::min(pictures.size(), kKeptPreviews); ++i) {
    const auto& [scene, width, height, png] = pictures[i];
    log_.events()->image(step, "preview/" + scene, width, height, png);
  }
}

void SessionLog::write_previews(int64_t step, double seconds) {
  log_.write(step, {{"preview_seconds", seconds}});
}

}  // namespace lte::train
