// The programs of examples/torchscript, which use an exported module as docs/torchscript.md tells.
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/torchscript/export.h"
#include "tests/support/temp_dir.h"

namespace lte::torchscript {
namespace {

/// By place: the network's answer and what radiosity says.
using Answers = std::map<std::string, std::array<double, 6>>;

Answers answers_of(const std::string& program, const std::filesystem::path& folder,
                   const std::string& model) {
  // One thread: more of them would spin while they wait for each other, many times as long.
  const std::string out = (folder / "out").string(),
                    command = concat("OMP_NUM_THREADS=1 ", program, " '", model, "' > '", out, "'");
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  std::ifstream file(out);
  Answers found;
  std::string line;
  while (std::getline(file, line)) {
    if (line.find("network") != std::string::npos) continue;  // a table's head
    std::istringstream numbers(line.substr(30));
    std::array<double, 6>& row = found[line.substr(0, line.find("  "))];
    for (double& value : row) numbers >> value;
    EXPECT_TRUE(numbers) << line;
  }
  return found;
}

class TorchscriptExample : public testing::Test {
 protected:
  std::string exported(const char* model) {
    const std::string out = (folder_.path() / "model.pt").string();
    export_torchscript({concat("assets/models/", model, ".safetensors"), out, true, {}});
    return out;
  }
  test::TempDir folder_;
};

TEST_F(TorchscriptExample, TheShippedModelAgreesWithRadiosity) {
  const Answers found =
      answers_of(LTE_BINARY_DIR "/bin/room_light", folder_.path(), exported("lte"));
  ASSERT_EQ(found.size(), 3u);
  for (const auto& [place, row] : found) {
    for (size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(row[c], row[c + 3], 0.3 * row[c + 3] + 0.05) << place << c;
  }
}

TEST_F(TorchscriptExample, RadianceIsWhatTheWallsSendOut) {
  const Answers found =
      answers_of(LTE_BINARY_DIR "/bin/room_light", folder_.path(), exported("lte-radiance"));
  ASSERT_EQ(found.size(), 6u) << "irradiance at three places, and radiance from another at each";
  for (const auto& [place, row] : found) {
    for (size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(row[c], row[c + 3], 0.3 * row[c + 3] + 0.05) << place << ' ' << c;
  }
}

TEST_F(TorchscriptExample, PythonGivesTheAnswersOfCpp) {
  // LTE_TORCH_PYTHON: a Python that has PyTorch.
  const char* const chosen = std::getenv("LTE_TORCH_PYTHON");
  const std::string python = chosen ? chosen : "python3";
  if (std::system((python + " -c 'import torch' 2>/dev/null").c_str()) != 0)
    GTEST_SKIP() << python << " has no PyTorch";
  // Without light, with solved light, and with radiance and gloss.
  for (const char* name : {"lte-paper", "lte", "lte-radiance"}) {
    const std::string model = exported(name);
    const Answers cpp = answers_of(LTE_BINARY_DIR "/bin/room_light", folder_.path(), model),
                  py = answers_of(python + " examples/torchscript/room_light.py", folder_.path(),
                                  model);
    ASSERT_EQ(cpp.size(), py.size());
    for (const auto& [place, row] : cpp) {
      for (size_t k = 0; k < 6; ++k) EXPECT_NEAR(py.at(place)[k], row[k], 2e-3) << place;
    }
  }
}

}  // namespace
}  // namespace lte::torchscript
