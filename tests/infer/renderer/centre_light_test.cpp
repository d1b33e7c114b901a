// Denoised pictures: less noise, the same light, and edges where they were.
#include "infer/renderer/centre_light.h"

#include <cmath>
#include <cstdlib>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "infer/renderer/renderer.h"
#include "lte/base/check.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/placement/auto_camera.h"
#include "tests/infer/fixture.h"
#include "tests/support/scenes.h"

namespace lte::infer {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

/// Leaves lte's own filter alone, whatever the machine has.
class CentreLightOwnFilter : public testing::Test {
 protected:
  void SetUp() override {
    if (const char* before = std::getenv("LTE_OIDN")) before_ = before;
    setenv("LTE_OIDN", "off", 1);
  }
  void TearDown() override {
    before_ ? setenv("LTE_OIDN", before_->c_str(), 1) : unsetenv("LTE_OIDN");
  }

 private:
  std::optional<std::string> before_;
};

RenderSettings settings(Output output, int samples) {
  RenderSettings out;
  out.output = output;
  out.width = 96;
  out.height = 64;
  out.direct_samples = samples;
  out.antialias = 0;
  return out;
}

double error(const image::Image& found, const image::Image& wanted) {
  double sum = 0;
  for (size_t i = 0; i < found.pixels.size(); ++i) {
    const double apart = found.pixels[i] - wanted.pixels[i];
    sum += apart * apart / (double{wanted.pixels[i]} * wanted.pixels[i] + 0.01);
  }
  return sum / static_cast<double>(found.pixels.size());
}

double sum(const image::Image& image) {
  double out = 0;
  for (const float value : image.pixels) out += value;
  return out;
}

TEST_F(CentreLightOwnFilter, TakesNoiseOutOfDirectLight) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  const scene::Camera camera = pathtrace::auto_camera(renderer.bvh());
  const Frame reference = renderer.render(camera, settings(Output::Direct, 1024));
  EXPECT_EQ(renderer.denoised_by(), "");
  RenderSettings wanted = settings(Output::Direct, 4);
  const Frame noisy = renderer.render(camera, wanted);
  wanted.denoise = Denoise::On;
  const Frame clean = renderer.render(camera, wanted);
  EXPECT_THAT(renderer.denoised_by(), StartsWith("lte's bilateral filter"));
  EXPECT_LT(error(clean.direct, reference.direct), 0.6 * error(noisy.direct, reference.direct));
  EXPECT_NEAR(sum(clean.direct), sum(reference.direct), 0.02 * sum(reference.direct));
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      if (*clean.depth.at(x, y) > 0) continue;
      EXPECT_EQ(clean.direct.rgb(x, y), Rgb{});
    }
  }
}

TEST_F(CentreLightOwnFilter, AutoIsOnForFewSamplesAlone) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  const scene::Camera camera = pathtrace::auto_camera(renderer.bvh());
  RenderSettings wanted = settings(Output::Direct, kDenoiseUpTo);
  wanted.width = wanted.height = 16;
  wanted.denoise = Denoise::Auto;
  renderer.render(camera, wanted);
  EXPECT_NE(renderer.denoised_by(), "");
  wanted.direct_samples = kDenoiseUpTo + 1;
  renderer.render(camera, wanted);
  EXPECT_EQ(renderer.denoised_by(), "");
  wanted.direct_samples = 1;
  wanted.mode = Mode::Reference;
  wanted.spp = 2;
  renderer.render(camera, wanted);
  EXPECT_EQ(renderer.denoised_by(), "") << "a reference is denoised on demand alone";
  wanted.output = Output::Depth;
  wanted.denoise = Denoise::On;
  renderer.render(camera, wanted);
  EXPECT_EQ(renderer.denoised_by(), "") << "depth has no noise";
}

/// Floor and lamp stand before the background: what is mixed in pixels at their edges is albedo and
/// emission, whatever light the denoiser found.
TEST_F(CentreLightOwnFilter, LeavesAntialiasedEdgesWhereTheyWere) {
  const scene::Scene scene = test::lit_floor();
  Renderer renderer(scene);
  RenderSettings wanted = settings(Output::Direct, 1024);
  wanted.antialias = 16;
  const Frame reference = renderer.render(test::outside_camera(), wanted);
  wanted.direct_samples = 8;
  wanted.denoise = Denoise::On;
  const Frame clean = renderer.render(test::outside_camera(), wanted);
  EXPECT_GT(reference.edge_pixels, 40);
  EXPECT_EQ(clean.edge_pixels, reference.edge_pixels);
  EXPECT_EQ(clean.albedo.pixels, reference.albedo.pixels);
  EXPECT_LT(error(clean.color, reference.color), 2e-3);
}

TEST_F(CentreLightOwnFilter, DenoisesReferencesOfEveryOutput) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  const scene::Camera camera = pathtrace::auto_camera(renderer.bvh());
  for (const Output output : {Output::Full, Output::Gi, Output::Irradiance, Output::Direct}) {
    RenderSettings wanted = settings(output, 64);
    wanted.mode = Mode::Reference;
    wanted.width = 48;
    wanted.height = 32;
    wanted.spp = 256;
    const Frame reference = renderer.render(camera, wanted);
    wanted.spp = 8;
    wanted.seed = 5;
    const Frame noisy = renderer.render(camera, wanted);
    wanted.denoise = Denoise::On;
    int64_t told = 0;
    wanted.done = [&](int64_t pixels) { told += pixels; };
    set_num_threads(1);  // `told` is not for several
    const Frame clean = renderer.render(camera, wanted);
    set_num_threads(0);
    EXPECT_EQ(told, 48 * 32) << enum_name(output);
    EXPECT_LT(error(clean.color, reference.color), 0.7 * error(noisy.color, reference.color))
        << enum_name(output);
    EXPECT_NEAR(sum(clean.color), sum(noisy.color), 0.03 * sum(noisy.color));
  }
}

/// A picture of many bands is denoised as one: no seam, and the same pixels.
TEST_F(CentreLightOwnFilter, DoesNotSeeBands) {
  const scene::Scene scene = test::furnished_room();
  Renderer renderer(scene);
  RenderSettings wanted = settings(Output::Direct, 2);
  wanted.width = 1024;
  wanted.height = 300;  // two bands of 2^18 pixels
  wanted.denoise = Denoise::On;
  const scene::Camera camera = pathtrace::auto_camera(renderer.bvh());
  const Frame frame = renderer.render(camera, wanted);
  const pathtrace::GBuffer hits = pathtrace::trace_gbuffer(renderer.bvh(), camera, 1024, 300);
  const image::Denoiser denoiser;
  CentreRequest request;
  request.shadow_rays = {2, false, false, 0};
  request.denoiser = &denoiser;
  const CentreLight light = light_centres(renderer.bvh(), renderer.lights(), hits, request);
  for (int y = 240; y < 270; ++y) {
    for (int x = 0; x < 1024; x += 13) {
      if (max_component(
              hits.albedo[size_t{1024} * static_cast<size_t>(y) + static_cast<size_t>(x)]) <= 0)
        continue;
      EXPECT_EQ(frame.direct.rgb(x, y), light.direct.rgb(x, y));
    }
  }
}

TEST(CentreLight, NamesWordsItDoesNotKnow) {
  EXPECT_EQ(parse_enum<Denoise>("--denoise", "auto"), Denoise::Auto);
  EXPECT_THAT([] { parse_enum<Denoise>("--denoise", "yes"); },
              ThrowsMessage<Error>(HasSubstr("expected auto | on | off")));
}

}  // namespace
}  // namespace lte::infer
