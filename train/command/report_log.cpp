#include "train/command/report_log.h"

#include <algorithm>
#include <sstream>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "train/log/json.h"

namespace lte::train {
namespace {

void add_numbers(const Json& object, double step, std::map<std::string, Series>* out) {
  for (const auto& [name, value] : object.items()) {
    if (value.is_number()) (*out)[name].emplace_back(step, value.get<double>());
  }
}

}  // namespace

const Series& RunHistory::figure(const std::string& name) const {
  static const Series kNone;
  const auto found = figures.find(name);
  return found == figures.end() ? kNone : found->second;
}

RunHistory read_run_log(const std::filesystem::path& path) {
  RunHistory out;
  std::istringstream lines(read_file(path));
  for (std::string line; std::getline(lines, line);) {
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object() || !json.contains("step") || !json["step"].is_number_integer()) continue;
    const auto step = json["step"].get<int64_t>();
    out.last_step = std::max(out.last_step, step);
    add_numbers(json, static_cast<double>(step), &out.figures);
    if (json.contains("val_scenes") && json["val_scenes"].is_object())
      add_numbers(json["val_scenes"], static_cast<double>(step), &out.scenes);
  }
  out.figures.erase("step");
  LTE_CHECK(!out.figures.empty(), path.string(), ": tells nothing yet; is it the log of a run?");
  return out;
}

}  // namespace lte::train
