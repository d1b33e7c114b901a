// Denoisers: which one is taken, and what Open Image Denoise does to light where it is found.
#include "lte/image/denoise.h"

#include <cmath>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/random.h"
#include "tests/support/temp_dir.h"

namespace lte::image {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

/// LTE_OIDN as it is told for as long as this lives.
class Chosen {
 public:
  explicit Chosen(const std::string& path) {
    if (const char* before = std::getenv("LTE_OIDN")) before_ = before;
    setenv("LTE_OIDN", path.c_str(), 1);
  }
  ~Chosen() { before_ ? setenv("LTE_OIDN", before_->c_str(), 1) : unsetenv("LTE_OIDN"); }

 private:
  std::optional<std::string> before_;
};

/// A floor and a wall that meet in the middle, half a metre apart where there is a `gap`; the light
/// on them, smooth on each, and the same with noise of this relative spread.
struct Corner {
  Corner(int width, int height, float spread)
      : light(width, height, 3), clean(light), normal(light), position(light), albedo(light) {
    Rng random(7);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const bool floor = 2 * y >= height;
        const float u = static_cast<float>(x) / 100, v = static_cast<float>(y) / 100;
        normal.set_rgb(x, y, floor ? Rgb{0, 1, 0} : Rgb{0, 0, 1});
        position.set_rgb(x, y, floor ? Vec3{u, 0, v} : Vec3{u, -v, 0});
        const Rgb texture =
            (x / 4 + y / 4) % 2 == 0 ? Rgb{0.8f, 0.8f, 0.8f} : Rgb{0.2f, 0.4f, 0.6f};
        albedo.set_rgb(x, y, texture);
        const Rgb truth = Rgb{2, 1.5f, 1} * (floor ? 1 + u : 0.2f);
        clean.set_rgb(x, y, truth);
        // Uniform, of mean 1 and never negative.
        light.set_rgb(x, y, truth * (1 + spread * random.uniform(-1, 1)));
      }
    }
  }
  NoisyPicture picture() const { return {&light, &normal, &position, nullptr, nullptr}; }

  Image light, clean, normal, position, albedo;
};

double mean_square(const Image& a, const Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i)
    sum += (a.pixels[i] - b.pixels[i]) * (a.pixels[i] - b.pixels[i]);
  return sum / static_cast<double>(a.pixels.size());
}

double mean(const Image& image) {
  double sum = 0;
  for (const float value : image.pixels) sum += value;
  return sum / static_cast<double>(image.pixels.size());
}

/// @param crossing  share of the step at the edge that may cross it, in the rows beside it
void expect_less_noise(const Denoiser& denoiser, double crossing) {
  const Corner corner(121, 96, 0.9f);
  const Image out = denoiser.denoise(corner.picture());
  EXPECT_LT(mean_square(out, corner.clean), 0.05 * mean_square(corner.light, corner.clean));
  EXPECT_NEAR(mean(out), mean(corner.light), 0.01 * mean(corner.light));
  for (int x = 10; x < 110; ++x) {
    const float wall = corner.clean.at(x, 47)[0], floor = corner.clean.at(x, 48)[0];
    EXPECT_NEAR(out.at(x, 47)[0], wall, crossing * (floor - wall));
    EXPECT_NEAR(out.at(x, 48)[0], floor, crossing * (floor - wall));
  }
}

TEST(Denoiser, TheFilterTakesNoiseAndKeepsTheMean) {
  expect_less_noise(Denoiser(DenoiseBy::Bilateral), 0.15);
}

TEST(Denoiser, TheFilterKeepsTexture) {
  const Corner corner(60, 40, 0);
  Image radiance = corner.clean;
  for (size_t i = 0; i < radiance.pixels.size(); ++i) radiance.pixels[i] *= corner.albedo.pixels[i];
  NoisyPicture picture = corner.picture();
  picture.light = &radiance;
  picture.albedo = &corner.albedo;
  const Image out = Denoiser(DenoiseBy::Bilateral).denoise(picture);
  for (size_t i = 0; i < radiance.pixels.size(); ++i)
    EXPECT_NEAR(out.pixels[i], radiance.pixels[i], 0.06f * radiance.pixels[i]);
}

TEST(Denoiser, TakesItsOwnFilterAndSaysWhyWhereTheLibraryIsMissing) {
  const test::TempDir dir;
  const Chosen chosen((dir.path() / "nothing.so").string());
  const Denoiser denoiser;
  EXPECT_FALSE(denoiser.is_oidn());
  EXPECT_THAT(denoiser.description(),
              AllOf(StartsWith("lte's bilateral filter"), HasSubstr("nothing.so")));
  EXPECT_THAT([] { Denoiser wanted(DenoiseBy::OpenImageDenoise); },
              ThrowsMessage<Error>(HasSubstr("Open Image Denoise was not found")));
}

TEST(Denoiser, RefusesALibraryOfAnotherKind) {
  const test::TempDir dir;
  const auto text = dir.path() / "text.so";
  write_file(text, "no library");
  EXPECT_THAT([&] { Oidn oidn(text); },
              ThrowsMessage<Error>(AllOf(HasSubstr("text.so"), HasSubstr("cannot be loaded"))));
  EXPECT_THAT([&] { Oidn oidn("libm.so.6"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("libm.so.6"), HasSubstr("has no oidnNewDevice"),
                                         HasSubstr("2.3.0 or later"))));
}

class OidnLibrary : public testing::Test {
 protected:
  void SetUp() override {
    std::string why_not;
    if (!Oidn::find(&why_not)) GTEST_SKIP() << "no Open Image Denoise: " << why_not;
  }
};

TEST_F(OidnLibrary, TakesNoiseKeepsTheMeanAndTheEdgesOfItsGuides) {
  const Denoiser denoiser;
  ASSERT_TRUE(denoiser.is_oidn());
  EXPECT_THAT(denoiser.description(), StartsWith("Open Image Denoise 2."));
  expect_less_noise(denoiser, 0.4);  // it softens edges by a pixel
}

TEST_F(OidnLibrary, TakesAnySizeAndHasNoOtherNumbersThanFiniteOnes) {
  const Denoiser denoiser;
  for (const auto& [width, height] : {std::pair(1, 1), {1, 9}, {17, 3}, {33, 65}}) {
    Corner corner(width, height, 0.5f);
    corner.light.pixels[0] = std::nanf("");
    const Image out = denoiser.denoise(corner.picture());
    ASSERT_EQ(out.width, width);
    ASSERT_EQ(out.height, height);
    for (const float value : out.pixels) EXPECT_TRUE(std::isfinite(value) && value >= 0);
  }
}

TEST_F(OidnLibrary, BackgroundStaysBlack) {
  Corner corner(64, 64, 0.5f);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 20; ++x) corner.normal.set_rgb(x, y, {0, 0, 0});
  }
  const Image out = Denoiser().denoise(corner.picture());
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 20; ++x) EXPECT_EQ(out.rgb(x, y), Rgb{});
  }
}

TEST_F(OidnLibrary, MovesAndNamesWhatIsWrong) {
  std::optional<Oidn> found = Oidn::find();
  Oidn oidn = std::move(*found);
  found.reset();
  const Corner corner(16, 16, 0.5f);
  EXPECT_EQ(oidn.denoise(corner.light, {&corner.albedo, &corner.normal}).width, 16);
  const Image small(4, 4, 3);
  EXPECT_THAT(
      [&] {
        oidn.denoise(corner.light, {&small, nullptr});
      },
      ThrowsMessage<Error>(HasSubstr("albedo of 4x4x3: expected 16x16x3")));
  EXPECT_THAT(
      [&] {
        oidn.denoise(corner.light, {nullptr, &corner.normal});
      },
      ThrowsMessage<Error>(HasSubstr("no normals without albedo")));
}

TEST(Denoiser, MakesNoLightOfNothing) {
  Corner corner(24, 16, 0.1f);
  corner.light = Image(24, 16, 3);
  for (const float value : Denoiser().denoise(corner.picture()).pixels) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace lte::image
