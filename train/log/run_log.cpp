#include "train/log/run_log.h"

#include <algorithm>
#include <exception>
#include <sstream>
#include <string_view>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/log.h"
#include "train/log/json.h"

namespace lte::train {
namespace {

std::string kept_lines(const std::string& text, int64_t resume_step) {
  std::string kept;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object() || !json.contains("step") || !json["step"].is_number_integer()) continue;
    if (json["step"].get<int64_t>() <= resume_step) kept += line + '\n';
  }
  return kept;
}

std::string tag_of(const std::string& field) {
  constexpr std::string_view kValidation = "val_";
  if (field.starts_with(kValidation)) return "val/" + field.substr(kValidation.size());
  if (field.starts_with(kModuleNormPrefix))
    return "grad_norm/" + field.substr(kModuleNormPrefix.size());
  if (field.starts_with(kModuleRmsPrefix))
    return "grad_rms/" + field.substr(kModuleRmsPrefix.size());
  if (field.starts_with(kHealthPrefix)) return "health/" + field.substr(kHealthPrefix.size());
  return "train/" + field;
}

}  // namespace

RunLog::RunLog(std::filesystem::path path, int64_t resume_step,
               const std::optional<std::string>& saved)
    : path_(std::move(path)) {
  if (saved) {
    text_ = *saved;
  } else if (resume_step > 0 && std::filesystem::exists(path_)) {
    text_ = kept_lines(read_file(path_), resume_step);
  }
  write_waiting();
}

RunLog::~RunLog() {
  try {
    if (written_ < text_.size()) write_waiting();
    if (written_ < text_.size())
      log_warning(path_.string(), ": ", waiting_lines(), " lines could not be written (", fault_,
                  "); --resume writes them, or does their steps again");
  } catch (const std::exception& error) {
    log_warning(error.what());
  }
}

int64_t RunLog::waiting_lines() const {
  return std::count(text_.begin() + static_cast<std::ptrdiff_t>(written_), text_.end(), '\n');
}

void RunLog::write_waiting() {
  const int64_t lines = waiting_lines();
  std::string fault;
  if (file_) {
    if (!file_->append(std::string_view(text_).substr(written_))) fault = file_->fault();
  } else {
    try {
      write_file(path_, text_);
      file_ = std::make_unique<AppendFile>(path_);
    } catch (const DiskFull& error) {
      fault = error.what();
    }
  }
  if (fault.empty()) written_ = text_.size();
  if (fault.empty() && !fault_.empty())
    log_warning(path_.string(), ": there is room again; ", lines, " lines are written late");
  if (!fault.empty() && fault_.empty())
    log_warning(path_.string(), ": cannot append: ", fault, "; lines wait until there is room");
  fault_ = fault;
}

void RunLog::write(int64_t step, const NamedValues& fields, const NamedValues& scenes) {
  Json json = {{"step", step}};
  for (const auto& [name, value] : fields) json[name] = value;
  for (const auto& [name, value] : scenes) json["val_scenes"][name] = value;
  text_ += json.dump() + '\n';
  write_waiting();
  if (!events_) return;
  NamedValues tagged;
  for (const auto& [name, value] : fields) tagged.emplace_back(tag_of(name), value);
  events_->scalars(step, tagged);
}

}  // namespace lte::train
