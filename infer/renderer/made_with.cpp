#include "infer/renderer/made_with.h"

#include <sstream>

#include "lte/base/check.h"
#include "lte/base/version.h"
#include "lte/cli/cli.h"
#include "lte/scene/fingerprint.h"

namespace lte::infer {
namespace {

/// Flags of all tools that change no result, or whose effect is in the fingerprints.
const std::set<std::string> kNoMatter = {
    "scene",        "out",           "resume",     "threads",       "quiet",
    "log-file",     "json",          "checkpoint", "embedding",     "save-embedding",
    "print-config", "validate-only", "help",       "allow-outside", "limits",
    "environment",  "add-light",     "up",         "version"};

}  // namespace

MadeWith made_with(CLI::App& app, const scene::Scene& scene, const runtime::Network* network,
                   const std::set<std::string>& no_matter) {
  MadeWith out;
  std::istringstream lines(config_text(app));
  for (std::string line; std::getline(lines, line);) {
    const size_t equals = line.find('=');
    const std::string name = line.substr(0, equals);
    if (equals == std::string::npos || kNoMatter.contains(name) || no_matter.contains(name))
      continue;
    out["--" + name] = line.substr(equals + 1);
  }
  const scene::Fingerprint print = fingerprint(scene);
  out["scene geometry"] = print.geometry;
  out["scene materials"] = print.materials;
  out["scene lights"] = print.lights;
  out["model"] = network != nullptr ? network->fingerprint() : "none";
  out["version of lte"] = version();
  return out;
}

void check_made_with(const std::string& file, const std::string& what, const MadeWith& there,
                     const MadeWith& here, const std::string& hint) {
  for (const auto& [name, value] : here) {
    const auto found = there.find(name);
    const std::string was = found == there.end() ? "nothing" : found->second;
    LTE_CHECK(was == value, file, ": ", what, " made with another ", name, ": ", was.substr(0, 80),
              ", here it is ", value, hint);
  }
}

}  // namespace lte::infer
