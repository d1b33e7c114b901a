#include "train/data/solved_light.h"

#include <fstream>

#include <gtest/gtest.h>

#include "lte/base/safetensors.h"
#include "tests/support/captured_log.h"
#include "tests/support/temp_dir.h"
#include "tests/train/support.h"
#include "train/data/scene_store.h"

namespace lte::train {
namespace {

/// A lamp above three points of a floor.
struct FloorAndLamp {
  std::vector<Vec3> position = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 2, 0}};
  std::vector<Vec3> normal = {{0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {0, -1, 0}};
  std::vector<Rgb> albedo = std::vector<Rgb>(4, {0.5f, 0.6f, 0.7f});
  std::vector<Rgb> emission = {{}, {}, {}, {3, 2, 1}};
  std::vector<float> area = std::vector<float>(4, 0.5f);
  std::vector<int32_t> group = {-1, -1, -1, 0};

  radiosity::Points points() const { return {position, normal, albedo, emission, area, group}; }
};

void expect_same(const radiosity::PointIrradiance& a, const radiosity::PointIrradiance& b) {
  EXPECT_EQ(a.direct, b.direct);
  EXPECT_EQ(a.indirect, b.indirect);
  EXPECT_EQ(a.direct_back, b.direct_back);
  EXPECT_EQ(a.indirect_back, b.indirect_back);
}

TEST(SolvedLight, IsReadFromItsFile) {
  const test::TempDir dir;
  const FloorAndLamp scene;
  const radiosity::PointIrradiance solved = radiosity::solve(scene.points(), 1);
  ASSERT_GT(solved.direct[1].x, 0);
  expect_same(solved_light(dir.path() / "light", "a", scene.points(), 1), solved);
  expect_same(solved_light(dir.path() / "light", "a", scene.points(), 1), solved);

  // What the file says is what is returned: nothing is solved again.
  const std::filesystem::path path = dir.path() / "light" / "a.safetensors";
  SafetensorsWriter writer;
  const std::vector<float> sevens(12, 7.0f);
  for (const char* part : {"direct", "indirect", "direct_back", "indirect_back"})
    writer.add(part, {1, 4, 3}, sevens.data());
  writer.set_metadata("fingerprint", SafetensorsFile(path).metadata("fingerprint"));
  writer.write(path);
  EXPECT_EQ(solved_light(dir.path() / "light", "a", scene.points(), 1).indirect_back,
            std::vector<Rgb>(4, Rgb{7, 7, 7}));
}

TEST(SolvedLight, OfOtherPointsIsReplaced) {
  const test::TempDir dir;
  FloorAndLamp scene;
  solved_light(dir.path(), "a", scene.points(), 1);
  scene.emission[3] = {30, 20, 10};
  const radiosity::PointIrradiance brighter = radiosity::solve(scene.points(), 1);
  for (int again = 0; again < 2; ++again)
    expect_same(solved_light(dir.path(), "a", scene.points(), 1), brighter);
  EXPECT_EQ(solved_light(dir.path(), "a", scene.points(), 2).direct.size(), 8u) << "more groups";
}

TEST(SolvedLight, DamagedFilesAreReplaced) {
  const test::TempDir dir;
  const FloorAndLamp scene;
  const radiosity::PointIrradiance solved = solved_light(dir.path(), "a", scene.points(), 1);
  const std::filesystem::path path = dir.path() / "a.safetensors";
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 4);
  const std::string said = test::stderr_of(LogLevel::Info, [&] {
    expect_same(solved_light(dir.path(), "a", scene.points(), 1), solved);
  });
  EXPECT_NE(said.find(path.string()), std::string::npos) << said;
  EXPECT_NO_THROW(SafetensorsFile(path).verify());
}

TEST(SolvedLight, IsReturnedWhereItCannotBeKept) {
  const test::TempDir dir;
  std::ofstream(dir.path() / "file") << "no folder";
  const FloorAndLamp scene;
  const std::string said = test::stderr_of(LogLevel::Info, [&] {
    expect_same(solved_light(dir.path() / "file", "a", scene.points(), 1),
                radiosity::solve(scene.points(), 1));
  });
  EXPECT_NE(said.find("cannot be kept"), std::string::npos) << said;
}

TEST(SolvedLight, GivesTheSameTrainingSceneKeptOrNot) {
  const test::TempDir dir;
  test::write_dataset(dir.path(), 1, 0);
  const std::filesystem::path path = data::scene_path(dir.path(), "room0");
  const auto read = [&](const std::filesystem::path& solved) {
    return read_training_scene(path, "room0", nn::LightInput::Radiosity, solved);
  };
  const TrainingScene fresh = read({});
  ASSERT_FALSE(fresh.direct_back.empty());
  for (int again = 0; again < 2; ++again) {
    const TrainingScene kept = read(dir.path() / "light");
    EXPECT_EQ(kept.direct, fresh.direct);
    EXPECT_EQ(kept.indirect_back, fresh.indirect_back);
  }
}

}  // namespace
}  // namespace lte::train
