// The one list of tensors: what it names is written, read back and documented.
#include <cstring>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "lte/base/file.h"
#include "lte/base/safetensors.h"
#include "tests/data/sample_fixture.h"

namespace lte::data::test {
namespace {

class SampleTensors : public Folder {};

/// A sample with every tensor that one may have.
SceneSample full_sample() {
  SceneSample sample = make_sample();
  const auto M = static_cast<size_t>(sample.scene_points()),
             N = static_cast<size_t>(sample.query_points()),
             G = static_cast<size_t>(sample.light_groups);
  Rng rng(21);
  sample.scene_direct = random_vectors(&rng, G * M, 0, 5);
  sample.scene_indirect = random_vectors(&rng, G * M, 0, 5);
  sample.scene_direct_back = random_vectors(&rng, G * M, 0, 5);
  sample.scene_indirect_back = random_vectors(&rng, G * M, 0, 5);
  sample.scene_error.assign(G * M, to_half(0.5f));
  sample.scene_error_back.assign(G * M, to_half(1.0f));
  sample.scene_metallic.assign(M, 0.75f);
  sample.scene_roughness.assign(M, 0.25f);
  for (size_t i = 0; i < N; ++i) sample.query_rays.push_back(static_cast<int32_t>(64 * i));
  for (auto& picture : sample.views[0].path_traced_few)
    picture = random_vectors(&rng, sample.views[0].mask.size(), 0, 5);
  sample.incident = make_incident(&rng, 3, 4, G);
  return sample;
}

/// What the list says of a tensor, and its bytes.
struct Listed {
  DType dtype;
  std::vector<int64_t> shape;
  bool optional;
  std::string bytes;

  bool operator==(const Listed&) const = default;
};

std::map<std::string, Listed> list(const SceneSample& sample) {
  std::map<std::string, Listed> out;
  for_each_tensor(sample, [&out]<typename T>(const TensorRule& rule, const std::vector<T>& values) {
    const auto* const first = reinterpret_cast<const char*>(values.data());
    const Listed listed{dtype_of<ScalarOf<T>>(), file_shape<T>(rule), rule.optional(),
                        std::string(first, values.size() * sizeof(T))};
    EXPECT_TRUE(out.emplace(rule.name, listed).second) << rule.name << " is listed twice";
  });
  return out;
}

TEST_F(SampleTensors, AllAreWrittenAndComeBackBitForBit) {
  const SceneSample sample = full_sample();
  const auto path = folder_ / "full.safetensors";
  write_scene_sample(path, sample);
  const auto listed = list(sample);
  EXPECT_EQ(list(read_scene_sample(path)), listed);
  const SafetensorsFile file(path);
  EXPECT_EQ(file.tensors().size(), listed.size());
  for (const auto& [name, expected] : listed) {
    EXPECT_FALSE(expected.bytes.empty()) << name << ": full_sample() lacks it";
    ASSERT_TRUE(file.contains(name)) << name;
    const TensorView& tensor = file.at(name);
    EXPECT_EQ(tensor.dtype, expected.dtype) << name;
    EXPECT_EQ(tensor.shape, expected.shape) << name;
    ASSERT_EQ(tensor.size_bytes(), expected.bytes.size()) << name;
    EXPECT_EQ(std::memcmp(tensor.data, expected.bytes.data(), expected.bytes.size()), 0) << name;
  }
}

TEST_F(SampleTensors, ThatAreNotOptionalAreMissedByName) {
  const auto path = folder_ / "full.safetensors", broken = folder_ / "broken.safetensors";
  write_scene_sample(path, full_sample());
  const SafetensorsFile file(path);
  for (const auto& [gone, rule] : list(full_sample())) {
    SafetensorsWriter writer;
    for (const auto& [key, value] : file.metadata()) writer.set_metadata(key, value);
    for (const auto& [name, tensor] : file.tensors())
      if (name != gone) writer.add(name, tensor);
    writer.write(broken);
    const std::string error = error_of([&] { read_scene_sample(broken); });
    if (!rule.optional) {
      EXPECT_NE(error.find(gone), std::string::npos) << gone << ": " << error;
      EXPECT_NE(error.find("broken.safetensors"), std::string::npos) << error;
    }
  }
}

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : line) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// Tensors and types by the tables of docs/dataset.md, whose rows start with one name or more in
/// backticks: `_normal` after `view<k>_position` stands for `view<k>_normal`.
std::map<std::string, std::string> documented() {
  std::map<std::string, std::string> out;
  bool in_table = false;
  for (const std::string& line : split(read_file(LTE_SOURCE_DIR "/docs/dataset.md"), '\n')) {
    if (line.rfind("| tensor |", 0) == 0) in_table = true;
    if (line.rfind('|', 0) != 0) in_table = false;
    const std::vector<std::string> cells = split(line, '|');
    if (!in_table || cells.size() < 4 || cells[1].find('`') == std::string::npos) continue;
    const std::vector<std::string> quoted = split(cells[1], '`');
    std::string name;
    for (size_t i = 1; i < quoted.size(); i += 2) {
      name = quoted[i][0] == '_' ? name.substr(0, name.rfind('_')) + quoted[i] : quoted[i];
      out[name] = cells[3].substr(1, cells[3].size() - 2);
    }
  }
  return out;
}

TEST_F(SampleTensors, AreTheOnesThatTheDocumentationNames) {
  std::map<std::string, std::string> expected;
  for (const auto& [name, listed] : list(full_sample())) {
    const bool of_view = name.rfind("view0_", 0) == 0;
    expected[of_view ? "view<k>_" + name.substr(6) : name] = dtype_name(listed.dtype);
  }
  EXPECT_EQ(documented(), expected);
}

}  // namespace
}  // namespace lte::data::test
