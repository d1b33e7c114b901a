#include "tests/train/run_fixture.h"

#include <cstring>

#include <ATen/Parallel.h>

#include "lte/base/safetensors.h"

namespace lte::test {

TempDir* RunFixture::data_ = nullptr;

void RunFixture::SetUpTestSuite() {
  at::set_num_threads(1);  // the matrices are tiny: threads would only wait for one another
  data_ = new TempDir;
  write_dataset(data_->path(), 4, 2);
}

void RunFixture::TearDownTestSuite() { delete data_; }

void expect_same_tensors(const std::filesystem::path& a, const std::filesystem::path& b) {
  const SafetensorsFile first(a), second(b);
  ASSERT_EQ(first.tensors().size(), second.tensors().size());
  for (const auto& [name, tensor] : first.tensors()) {
    if (name == "log") continue;
    const TensorView& other = second.at(name);
    ASSERT_EQ(tensor.shape, other.shape) << name;
    EXPECT_EQ(std::memcmp(tensor.data, other.data, tensor.size_bytes()), 0) << name;
  }
}

std::vector<nlohmann::json> log_values(const std::filesystem::path& run) {
  std::vector<nlohmann::json> lines;
  for (const std::string& text : lines_of(run / "log.jsonl")) {
    nlohmann::json json = nlohmann::json::parse(text);
    for (const char* measured : {"queries_per_s", "seconds", "wait_share", "rss_mb", "val_seconds"})
      json.erase(measured);
    lines.push_back(json);
  }
  return lines;
}

}  // namespace lte::test
