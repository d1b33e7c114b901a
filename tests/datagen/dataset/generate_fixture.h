// Data sets of tiny scenes in a folder of their own.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datagen/dataset/generate.h"
#include "lte/base/log.h"
#include "lte/base/parallel.h"
#include "tests/data/sample_fixture.h"
#include "tests/datagen/scenes.h"
#include "tests/support/folder_files.h"

namespace lte::datagen::test {

inline std::vector<float> floats(const std::vector<Rgb>& values) {
  std::vector<float> out;
  for (const Rgb& value : values) out.insert(out.end(), {value.x, value.y, value.z});
  return out;
}

class Generate : public data::test::Folder {
 protected:
  void SetUp() override { set_log_level(LogLevel::Quiet); }
  void TearDown() override {
    set_log_level(LogLevel::Info);
    set_num_threads(0);
  }

  GenerateResult generate(const std::string& out, const DatagenConfig& config = tiny_config(),
                          bool resume = false, int64_t shard = 0, int64_t shards = 1) const {
    GenerateOptions options;
    options.out = folder_ / out;
    options.resume = resume;
    options.shard = {shard, shards};
    return generate_dataset(config, options);
  }

  /// But the manifests, which hold times.
  std::map<std::string, std::string> files(const std::string& out) const {
    return lte::test::folder_files(folder_ / out);
  }
};

}  // namespace lte::datagen::test
