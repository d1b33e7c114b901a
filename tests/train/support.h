// A small data set with a closed-form light transport, and runs on it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lte/data/dataset.h"
#include "tests/support/temp_dir.h"
#include "train/config.h"
#include "train/data/scene_store.h"

namespace lte::test {

/// A box room of `points` random surface points, two luminaires of eight points under its ceiling,
/// and `queries` query points on its walls. Direct irradiance of a query is the sum over emitting
/// points, indirect one bounce off all points, as transport() computes them: nothing is hidden
/// between points, so this is an exact functional of them.
data::SceneSample box_sample(uint64_t seed, int64_t points = 256, int64_t queries = 200);

/// Direct and one-bounce irradiance at queries, from emitting and reflecting points.
struct Transport {
  std::vector<Rgb> direct, indirect;
};
Transport transport(const std::vector<Vec3>& position, const std::vector<Vec3>& normal,
                    const std::vector<Rgb>& albedo, const std::vector<Rgb>& emission,
                    const std::vector<float>& area, const std::vector<Vec3>& query_position,
                    const std::vector<Vec3>& query_normal);

/// Writes `train` + `val` box rooms, named room0, room1, ...; `edit` may change each before it is
/// written.
void write_dataset(const std::filesystem::path& root, int train, int val,
                   const std::function<void(int, data::SceneSample*)>& edit = {});

/// Adds metal to the scene points, and incident radiance at `points` of the queries in 4 x 4 cells:
/// of each group brighter towards its luminaire, and in proportion to its emission.
void add_incident(data::SceneSample* sample, int64_t points = 60);

/// Smallest network that has every part, some steps, no augmentation off.
std::string tiny_yaml(const std::filesystem::path& root, const std::filesystem::path& output);
train::TrainConfig tiny_config(const std::filesystem::path& root,
                               const std::filesystem::path& output, const std::string& extra = "");

/// Expects lte::Error (or any exception) whose message contains every one of `parts`.
void expect_error(const std::function<void()>& body, const std::vector<std::string>& parts);

/// Lines of a text file.
std::vector<std::string> lines_of(const std::filesystem::path& path);

}  // namespace lte::test
