// Pictures of validation views, and the page that shows them.
#include "train/loop/preview.h"

#include <fstream>

#include "lte/base/file.h"
#include "lte/base/srgb.h"
#include "lte/image/png.h"
#include "tests/train/support.h"
#include "train/command/report_command.h"
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

TEST_F(PreviewTest, ARunDrawsThemAndItsReportShowsThem) {
  const TrainConfig config = test::tiny_config(
      data_.path(), dir_ / "run",
      "train: {steps: 4, validate_every: 2, log_every: 1, preview_every: 3, preview_scenes: 1}");
  Trainer(config, test::tiny_yaml(data_.path(), dir_ / "run"), at::kCPU, false).run();
  EXPECT_TRUE(std::filesystem::exists(dir_ / "run/previews/room2.png"));
  EXPECT_TRUE(std::filesystem::exists(dir_ / "run/previews/step_000000003/room2.png"));
  EXPECT_TRUE(std::filesystem::exists(dir_ / "run/previews/step_000000004/room2.png"));
  EXPECT_FALSE(std::filesystem::is_empty(dir_ / "run/tensorboard"));
  const std::string said = write_run_report(dir_ / "run");
  EXPECT_NE(said.find("report.html"), std::string::npos);
  const std::string page = read_file(dir_ / "run/report.html");
  for (const char* part :
       {"<svg", "learning rate", "gradient norm", ">whole gradient<", ">encoder_down0<",
        ">decoder<", "room2", "room3", "data:image/png;base64,", "queries a second"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(page.find("http"), std::string::npos) << "the page stands alone";
}

TEST_F(PreviewTest, CanBeSwitchedOff) {
  const TrainConfig config = test::tiny_config(
      data_.path(), dir_ / "run", "train: {steps: 1, preview_every: 0, tensorboard: false}");
  Trainer(config, "", at::kCPU, false).run();
  EXPECT_FALSE(std::filesystem::exists(dir_ / "run/previews"));
  EXPECT_FALSE(std::filesystem::exists(dir_ / "run/tensorboard"));
}

TEST(RunReport, TakesLogsWithoutNormsOfModules) {
  const test::TempDir dir;
  std::ofstream(dir / "log.jsonl") << "{\"step\":1,\"loss\":3,\"grad_norm\":0.5}\n"
                                      "{\"step\":2,\"loss\":2,\"grad_norm\":0.25}\n";
  std::ofstream(dir / "config.yaml") << "train: {steps: 2}\n";
  write_run_report(dir.path());
  EXPECT_NE(read_file(dir / "report.html").find(">whole gradient<"), std::string::npos);
}

TEST(RunReport, LeadsWithFiguresAndWarnsOfARisingLoss) {
  const test::TempDir dir;
  std::ofstream(dir / "config.yaml") << "train: {steps: 20}\n";
  const auto page_of = [&](const char* last) {
    std::ofstream(dir / "log.jsonl")
        << "{\"step\":1,\"loss\":3,\"val_loss\":0.5,\"val_psnr\":20,\"val_scenes\":{\"a\":0.5}}\n"
        << "{\"step\":9,\"loss\":2,\"val_loss\":" << last << ",\"val_psnr\":21.5}\n";
    write_run_report(dir.path());
    return read_file(dir / "report.html");
  };
  const std::string risen = page_of("0.75");
  const size_t headline = risen.find("Validation loss 0.75, PSNR 21.5 dB, at step 9 of 20");
  ASSERT_NE(headline, std::string::npos);
  EXPECT_LT(headline, risen.find("<h2>Pictures"));
  EXPECT_LT(risen.find("<h2>Pictures"), risen.find("<svg"));
  EXPECT_NE(risen.find("lowest at step 1 (0.5) and has risen by 50 %"), std::string::npos);
  EXPECT_EQ(page_of("0.51").find("class=warning"), std::string::npos);
}

TEST(RunReport, NamesWhatIsMissing) {
  const test::TempDir dir;
  test::expect_error([] { write_run_report("/nonexistent/run"); }, {"/nonexistent/run"});
  test::expect_error([&] { write_run_report(dir.path()); }, {"log.jsonl"});
  std::ofstream(dir / "log.jsonl") << "no JSON\n";
  test::expect_error([&] { write_run_report(dir.path()); }, {"log.jsonl", "nothing"});
}

}  // namespace
}  // namespace lte::train
