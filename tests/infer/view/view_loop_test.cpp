#include "infer/view/view_loop.h"

#include <cstring>
#include <fstream>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "infer/view/session_scene.h"
#include "lte/base/srgb.h"
#include "lte/image/exr.h"
#include "lte/image/png.h"
#include "lte/scene/load_camera.h"
#include "tests/infer/fixture.h"
#include "tests/infer/view/fake_pages.h"
#include "tests/support/temp_dir.h"

namespace lte::infer::view {
namespace {

using nlohmann::json;

/// A lit floor that paths answer for, seen by some pages.
class Viewed {
 public:
  explicit Viewed(int pages = 1)
      : pages_(pages),
        session_(test::lit_floor(), std::nullopt),
        scene_(std::make_shared<const SceneDescription>(
            describe_scene(*state(), list_objects(*state())))) {}

  std::unique_ptr<ViewLoop> loop(Shown shown = Shown::Direct, ViewLoop::AtRest at_rest = {}) {
    ViewState first;
    first.camera = test::downward_camera();
    first.size = {24, 18};
    auto out = std::make_unique<ViewLoop>(
        [this] {
          return Editor::Made{state(), scene_};
        },
        &pages_, first, std::move(at_rest));
    ChangeView view;
    view.shown = shown;
    out->post(9, 1, view);
    return out;
  }
  StatePtr state() const { return session_.state(); }
  Session* session() { return &session_; }
  test::FakePages* pages() { return &pages_; }
  const SceneDescription& scene() const { return *scene_; }

 private:
  test::FakePages pages_;
  Session session_;
  std::shared_ptr<const SceneDescription> scene_;
};

MoveCamera camera_at(float height) {
  MoveCamera move;
  move.camera = test::downward_camera();
  move.camera.origin.y = height;
  return move;
}

bool handled(const json& header, int client, int64_t number) {
  const json& all = header.at("handled");
  const std::string key = std::to_string(client);
  return all.contains(key) && all.at(key).at(0).get<int64_t>() >= number;
}

TEST(ViewLoop, OfABurstOfCamerasTheLastIsShownAndFewAreRendered) {
  Viewed viewed;
  const auto loop = viewed.loop();
  viewed.pages()->wait_for_picture([](const json& header) { return header.at("done") == true; });
  const ViewLoop::Counts before = loop->counts();
  for (int i = 1; i <= 100; ++i) loop->post(1, i, camera_at(1 + 0.005f * static_cast<float>(i)));
  const std::string last = viewed.pages()->wait_for_picture(
      [](const json& header) { return handled(header, 1, 100) && header.at("done") == true; });
  ASSERT_FALSE(last.empty());
  EXPECT_NEAR(test::frame_header(last).at("camera").at("origin").at(1).get<double>(), 1.5, 1e-6);
  EXPECT_LT(loop->counts().cameras - before.cameras, 50);
}

TEST(ViewLoop, TellsOfACameraThatRestsAndOfFewThatMove) {
  Viewed viewed;
  std::mutex mutex;
  std::vector<float> heights;
  const auto loop = viewed.loop(Shown::Direct, [&](const scene::Camera& camera) {
    const std::lock_guard lock(mutex);
    heights.push_back(camera.origin.y);
  });
  const auto told_last = [&] {
    const std::lock_guard lock(mutex);
    return heights.empty() ? 0 : heights.back();
  };
  for (int i = 1; i <= 50; ++i) {
    loop->post(1, i, camera_at(1 + 0.01f * static_cast<float>(i)));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  for (int i = 0; i < 60'000 && told_last() != 1.5f; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(told_last(), 1.5f);
  const std::lock_guard lock(mutex);
  EXPECT_LT(heights.size(), 25u);
}

TEST(ViewLoop, ManyPagesCostOneRendering) {
  const auto passes = [](int pages) {
    Viewed viewed(pages);
    const auto loop = viewed.loop();
    viewed.pages()->wait_for_picture([](const json& header) { return header.at("done") == true; });
    return loop->counts().passes;
  };
  EXPECT_LE(passes(20), passes(1) + 2);  // a draft may have begun before the first message
}

TEST(ViewLoop, WithoutPagesNothingIsRendered) {
  Viewed viewed(0);
  const auto loop = viewed.loop();
  for (int i = 1; i <= 5; ++i) loop->post(1, i, camera_at(1.2f));
  loop->post(1, 6, PickAt{0.5f, 0.5f});
  EXPECT_EQ(viewed.pages()->wait_for_text("picked").at("object"), 0);  // all before was handled
  EXPECT_EQ(loop->counts().passes, 0);
}

TEST(ViewLoop, ADimmedLightIsShownAsLinearLightSays) {
  Viewed viewed;
  const auto loop = viewed.loop();
  const auto done = [](uint64_t edits) {
    return [edits](const json& header) {
      return header.at("done") == true && header.at("shown") == "direct" &&
             header.at("picture").get<uint64_t>() > edits;
    };
  };
  const std::string bright = viewed.pages()->wait_for_picture(done(0));
  ASSERT_FALSE(bright.empty());
  const auto number = test::frame_header(bright).at("picture").get<uint64_t>();
  viewed.session()->apply(SetLight{viewed.scene().lights.at(0).id, 0.5, {}});
  loop->wake();
  const std::string dim = viewed.pages()->wait_for_picture(done(number));
  ASSERT_FALSE(dim.empty());
  const double ratio =
      test::mean_light(test::frame_picture(dim)) / test::mean_light(test::frame_picture(bright));
  EXPECT_NEAR(ratio, 0.5, 0.01);
}

TEST(ViewLoop, ATouchedLightIsDimmedWithoutRendering) {
  Viewed viewed;
  const int light = viewed.scene().lights.at(0).id;
  viewed.session()->separate();
  const auto loop = viewed.loop();
  const auto wait = [&](int64_t picture) {
    return viewed.pages()->wait_for_picture([picture](const json& header) {
      return header.at("done") == true && header.at("shown") == "direct" &&
             header.at("picture").get<int64_t>() > picture;
    });
  };
  const std::string bright = wait(0);
  ASSERT_FALSE(bright.empty());
  const int64_t passes = loop->counts().passes;
  viewed.session()->apply(SetLight{light, 0.25, Rgb{1, 0.5f, 0.5f}});
  loop->wake();
  const std::string dim = wait(test::frame_header(bright).at("picture"));
  ASSERT_FALSE(dim.empty());
  EXPECT_EQ(loop->counts().passes, passes);
  // By channel: the luminaire's own color is (1, 0.8, 0.6).
  const auto channel = [](const std::string& frame, size_t c) {
    const image::Image picture = test::frame_picture(frame);
    double sum = 0;
    for (size_t i = c; i < picture.pixels.size(); i += 3) sum += srgb_to_linear(picture.pixels[i]);
    return sum;
  };
  for (const auto& [c, law] : {std::pair(0, 0.25), {1, 0.25 * 0.5 / 0.8}, {2, 0.25 * 0.5 / 0.6}}) {
    const auto at = static_cast<size_t>(c);
    EXPECT_NEAR(channel(dim, at) / channel(bright, at), law, 0.02 * law + 0.003) << c;
  }
}

TEST(ViewLoop, ExposureChangesThePictureWithoutRendering) {
  Viewed viewed;
  const auto loop = viewed.loop();
  ChangeView darker;
  darker.ev = -1.0f;
  const std::string first = viewed.pages()->wait_for_picture(
      [](const json& header) { return header.at("done") == true; });
  const int64_t passes = loop->counts().passes;
  loop->post(1, 1, darker);
  const std::string second = viewed.pages()->wait_for_picture(
      [](const json& header) { return header.at("done") == true && header.at("ev") == -1.0; });
  ASSERT_FALSE(second.empty());
  EXPECT_EQ(loop->counts().passes, passes);
  EXPECT_NEAR(
      test::mean_light(test::frame_picture(second)) / test::mean_light(test::frame_picture(first)),
      0.5, 0.01);
}

TEST(ViewLoop, SavesWhatItShows) {
  Viewed viewed;
  const auto loop = viewed.loop();
  viewed.pages()->wait_for_picture([](const json& header) { return header.at("done") == true; });
  const test::TempDir folder;
  loop->post(1, 1, Save{SaveFormat::Exr});
  const std::string exr = viewed.pages()->wait_for_file();
  EXPECT_EQ(test::frame_header(exr).at("name"), "lit_floor.exr");
  std::ofstream(folder / "a.exr", std::ios::binary) << test::frame_bytes(exr);
  const image::Image linear = image::read_exr(folder / "a.exr");
  EXPECT_EQ(linear.width, 24);
  const scene::Camera camera = scene::load_camera(folder / "a.exr");
  EXPECT_EQ(camera.origin, test::downward_camera().origin);
  EXPECT_GT(linear.rgb(12, 9).x, linear.rgb(12, 9).y);
  EXPECT_NEAR(linear.rgb(12, 9).y / linear.rgb(12, 9).z, 4.0 / 3, 0.01) << "denoised";
}

/// A draft is no picture to keep: what is saved while the camera moves has the size of the view and
/// shows what the camera then saw.
TEST(ViewLoop, WhatIsSavedWhileTheCameraMovesIsTheWholePicture) {
  Viewed viewed;
  const auto loop = viewed.loop();
  ChangeView larger;
  larger.size = PictureSize{480, 360};  // of which a draft is a part
  loop->post(1, 1, larger);
  for (int i = 2; i <= 10; ++i) {
    loop->post(1, i, camera_at(1 + 0.01f * static_cast<float>(i)));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  loop->post(1, 11, Save{SaveFormat::Png});
  for (int i = 12; i <= 20; ++i) loop->post(1, i, camera_at(1.3f));
  const std::string first = viewed.pages()->wait_for_file();
  const image::Image png = image::decode_png(test::frame_bytes(first), "saved", 1 << 20);
  EXPECT_EQ(png.width, 480);
  EXPECT_EQ(png.height, 360);
  loop->post(1, 21, Save{SaveFormat::Exr});
  for (int i = 22; i <= 30; ++i) loop->post(1, i, camera_at(1.4f));
  std::string second = first;
  while (second == first) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    second = viewed.pages()->wait_for_file();
  }
  const test::TempDir folder;
  std::ofstream(folder / "a.exr", std::ios::binary) << test::frame_bytes(second);
  EXPECT_EQ(image::read_exr(folder / "a.exr").width, 480);
}

TEST(ViewLoop, PicksWhatIsSeen) {
  Viewed viewed;
  const auto loop = viewed.loop();
  loop->post(1, 1, PickAt{0.5f, 0.5f});
  const json picked = viewed.pages()->wait_for_text("picked");
  EXPECT_EQ(picked.at("object"), 0);
  EXPECT_NEAR(picked.at("position").at(1).get<double>(), 0, 1e-5);
  EXPECT_NEAR(picked.at("normal").at(1).get<double>(), 1, 1e-5);
}

}  // namespace
}  // namespace lte::infer::view
