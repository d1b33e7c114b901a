// Pictures of validation views.
#include "train/loop/preview.h"

#include <fstream>

#include "lte/base/file.h"
#include "lte/base/srgb.h"
#include "lte/image/png.h"
#include "tests/train/support.h"
#include "train/data/batch.h"
#include "train/data/run_data.h"
#include "train/loop/trainer.h"

namespace lte::train {
namespace {

constexpr int kWidth = 5, kHeight = 4;

/// A view whose pixels are the sample's first query points; the last pixel shows nothing.
void add_view(data::SceneSample* sample) {
  constexpr size_t kPixels = size_t{kWidth} * kHeight;
  data::View view;
  view.width = kWidth, view.height = kHeight;
  view.mask.assign(kPixels, 1);
  view.mask.back() = 0;
  view.variance.assign(kPixels, 0);
  const auto N = static_cast<size_t>(sample->query_points());
  for (size_t i = 0; i < kPixels; ++i) {
    const bool shown = view.mask[i] != 0;
    view.position.push_back(shown ? sample->query_position[i] : Vec3{});
    view.normal.push_back(shown ? sample->query_normal[i] : Vec3{});
    view.albedo.push_back(shown ? sample->query_albedo[i] : Rgb{});
  }
  for (size_t g = 0; g < static_cast<size_t>(sample->light_groups); ++g) {
    for (size_t i = 0; i < kPixels; ++i) {
      view.direct.push_back(view.mask[i] ? sample->direct[g * N + i] : Rgb{});
      view.indirect.push_back(view.mask[i] ? sample->indirect[g * N + i] : Rgb{});
    }
  }
  sample->views.push_back(view);
}

class PreviewTest : public testing::Test {
 protected:
  PreviewTest() {
    test::write_dataset(data_.path(), 2, 2, [](int room, data::SceneSample* sample) {
      if (room == 2) add_view(sample);  // the first of the two validation rooms
    });
  }

  test::TempDir data_, dir_;
};

TEST_F(PreviewTest, ShowsTheReferenceOfTheViewExposedAndEncoded) {
  const TrainConfig config = test::tiny_config(data_.path(), dir_ / "run");
  RunData data = open_run_data(config);
  const Previews previews(config, validation_examples(config, &data.val));
  nn::ModelConfig model_config = config.model;
  model_config.scale = data.scale;
  nn::LightTransportModel model(model_config);
  model->train();
  const std::vector<PreviewPicture> pictures = previews.draw(model, at::kCPU);
  EXPECT_TRUE(model->is_training());
  ASSERT_EQ(pictures.size(), 1u) << "the other room has no view";
  const PreviewPicture& picture = pictures[0];
  EXPECT_EQ(picture.scene, "room2");
  EXPECT_EQ(picture.width, 3 * kWidth + 4);
  EXPECT_EQ(picture.height, kHeight);
  write_file(dir_ / "picture.png",
             {reinterpret_cast<const char*>(picture.png.data()), picture.png.size()});
  const image::Image shown = image::read_png(dir_ / "picture.png");
  ASSERT_EQ(shown.width, picture.width);
  ASSERT_EQ(shown.height, picture.height);
  const data::SceneSample sample = data::read_scene_sample(data::scene_path(data_.path(), "room2"));
  const auto N = static_cast<size_t>(sample.query_points());
  std::vector<Rgb> reference;
  std::vector<float> luminances;
  for (size_t i = 0; i + 1 < size_t{kWidth} * kHeight; ++i) {
    Rgb sum;
    for (size_t g = 0; g < static_cast<size_t>(sample.light_groups); ++g)
      sum += sample.indirect[g * N + i];
    reference.push_back(sum);
    luminances.push_back(luminance(sum));
  }
  std::sort(luminances.begin(), luminances.end());
  const float white =
      luminances[static_cast<size_t>(0.99 * static_cast<double>(luminances.size() - 1))];
  for (size_t i = 0; i < reference.size(); ++i) {
    const Rgb found = shown.rgb(static_cast<int>(i) % kWidth, static_cast<int>(i) / kWidth);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(255 * found[c], 255 * linear_to_srgb(reference[i][c] / white), 1) << i;
  }
  EXPECT_EQ(shown.rgb(kWidth - 1, kHeight - 1), (Rgb{1, 1, 1})) << "background";
}

TEST_F(PreviewTest, ARunDrawsThem) {
  const TrainConfig config =
      test::tiny_config(data_.path(), dir_ / "run",
                        "train: {steps: 4, validate_every: 2, log_every: 1, preview_every: 3}");
  Trainer(config, test::tiny_yaml(data_.path(), dir_ / "run"), at::kCPU, false).run();
  EXPECT_TRUE(std::filesystem::exists(dir_ / "run/previews/room2.png"));
  EXPECT_TRUE(std::filesystem::exists(dir_ / "run/previews/step_000000003/room2.png"));
  EXPECT_TRUE(std::filesystem::exists(dir_ / "run/previews/step_000000004/room2.png"));
  EXPECT_FALSE(std::filesystem::is_empty(dir_ / "run/tensorboard"));
}

TEST_F(PreviewTest, CanBeSwitchedOff) {
  const TrainConfig config =
      test::tiny_config(data_.path(), dir_ / "run", "train: {steps: 1, preview_every: 0}");
  Trainer(config, "", at::kCPU, false).run();
  EXPECT_FALSE(std::filesystem::exists(dir_ / "run/previews"));
}

}  // namespace
}  // namespace lte::train
