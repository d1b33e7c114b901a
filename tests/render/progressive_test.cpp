// Films and pictures: passes until something ends them, halves, metal, edges, and that all
// integrators come to the same picture.
#include "lte/render/progressive.h"

#include <cmath>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/parallel.h"
#include "lte/base/timer.h"
#include "lte/pathtrace/gbuffer.h"
#include "lte/pathtrace/render.h"
#include "lte/render/picture.h"
#include "tests/render/scenes.h"

namespace lte::render {
namespace {

constexpr int kWidth = 48, kHeight = 32;

scene::Camera camera() { return test::camera_from({2.6f, 1.4f, 2.6f}, {0.9f, 0.6f, 0.9f}); }

struct Room {
  explicit Room(scene::Scene scene) : traced(std::move(scene)) {
    CacheSettings settings;
    settings.records = 1024;
    gather = make_gather(traced.view(), settings);
    gather->prepare();
  }
  Film film(const Integrator& integrator, const RenderSettings& settings,
            const Until& until) const {
    Film out(kWidth, kHeight);
    render::render(traced.view(), integrator, camera(), settings, until, &out);
    return out;
  }

  test::Traced traced;
  std::unique_ptr<Integrator> gather;
};

Until passes(int count) {
  Until out;
  out.passes = count;
  return out;
}

double mean_of(const image::Image& image) {
  double sum = 0;
  for (const float value : image.pixels) sum += double{value};
  return sum / static_cast<double>(image.pixels.size());
}

/// Root mean square difference over the mean of the second.
double difference(const image::Image& a, const image::Image& b) {
  double sum = 0;
  for (size_t k = 0; k < a.pixels.size(); ++k) {
    const double d = double{a.pixels[k]} - double{b.pixels[k]};
    sum += d * d;
  }
  return std::sqrt(sum / static_cast<double>(a.pixels.size())) / mean_of(b);
}

TEST(Progressive, GatheredAndPathTracedPicturesComeToTheSame) {
  const Room room(test::furnished_room());
  RenderSettings settings;
  settings.correct = false;
  settings.rays = settings.light_samples = 16;
  const Frame gathered =
      make_picture(room.film(*room.gather, settings, passes(16)), {Output::Full, nullptr, {}});
  const image::Image traced = pathtrace::render_reference(room.traced.bvh, room.traced.lights,
                                                          camera(), kWidth, kHeight, {512, 6, 77});
  EXPECT_NEAR(mean_of(gathered.color) / mean_of(traced), 1, 0.02);
  EXPECT_LT(difference(gathered.color, traced), 0.12);
}

TEST(Progressive, PathsAreTheReferenceOfThePathTracer) {
  const Room room(test::furnished_room());
  const auto path = make_path(room.traced.view(), 5);
  RenderSettings settings;
  settings.path_samples = 64;
  const Film film = room.film(*path, settings, passes(4));
  EXPECT_EQ(film.path_passes, 4);
  EXPECT_TRUE(film.gathered.empty());
  const Frame frame = make_picture(film, {Output::Full, nullptr, {}});
  const image::Image traced = pathtrace::render_reference(room.traced.bvh, room.traced.lights,
                                                          camera(), kWidth, kHeight, {512, 6, 77});
  EXPECT_NEAR(mean_of(frame.color) / mean_of(traced), 1, 0.01);
}

TEST(Progressive, TheLastPassHasWhatIsLeftOfThePaths) {
  const Room room(test::furnished_room());
  RenderSettings settings;
  settings.path_samples = 3;
  settings.max_samples = 7;
  const Film film = room.film(*make_path(room.traced.view(), 5), settings, passes(3));
  EXPECT_EQ(film.path_passes, 3);
  for (size_t i = 0; i < film.pixels(); ++i) ASSERT_EQ(film.paths.samples(i), 7);
}

TEST(Progressive, InAFurnaceEveryPixelShowsTheSum) {
  const test::Traced furnace(test::furnace(0.5f, 2));
  const auto path = make_path(furnace.view(), 5);
  RenderSettings settings;
  settings.path_samples = 32;
  Film film(16, 16);
  render::render(furnace.view(), *path, test::camera_from({1, 1, 1}, {0, 1, 1}), settings,
                 passes(2), &film);
  const Frame frame = make_picture(film, {Output::Full, nullptr, {}});
  // 2 (1 + 1/2 + ... + 1/32): the lamps, and five bounces.
  EXPECT_NEAR(mean_of(frame.color), 2 * (2 - 1.0 / 32), 0.03);
  EXPECT_NEAR(mean_of(frame.emission), 2, 1e-4);
}

TEST(Progressive, IrradianceHasNoTextureAndLampsAreNoPart) {
  const test::Traced furnace(test::furnace(0.5f, 2));
  const auto path = make_path(furnace.view(), 5);
  RenderSettings settings;
  settings.irradiance = true;
  settings.direct = false;
  settings.rays = 64;
  Film film(16, 16);
  render::render(furnace.view(), *path, test::camera_from({1, 1, 1}, {0, 1, 1}), settings,
                 passes(4), &film);
  const Frame frame = make_picture(film, {Output::Irradiance, nullptr, {}});
  const double expected = kPi * 2 * (1 - 1.0 / 16);  // pi L (a + a² + a³ + a⁴)
  EXPECT_NEAR(mean_of(frame.color), expected, 0.03 * expected);
}

/// The mean over many rays a pixel that read the finest texels.
image::Image unfiltered_albedo(const test::Traced& traced, int rays) {
  std::vector<Vec2> places;
  for (int i = 0; i < kWidth * kHeight * rays * rays; ++i) {
    const int pixel = i / (rays * rays), k = i % (rays * rays);
    const auto at = [&](int whole, int part) {
      return static_cast<float>(whole) +
             (static_cast<float>(part) + 0.5f) / static_cast<float>(rays);
    };
    places.push_back({at(pixel % kWidth, k % rays), at(pixel / kWidth, k / rays)});
  }
  pathtrace::GBuffer hits;
  pathtrace::append_image_points(traced.bvh, camera(), kWidth, kHeight, places, &hits, 0);
  image::Image out(kWidth, kHeight, 3);
  for (size_t i = 0; i < places.size(); ++i) {
    const size_t pixel = i / static_cast<size_t>(rays * rays);
    out.set_rgb(pixel, out.rgb(pixel) + hits.albedo[i] * (1 / static_cast<float>(rays * rays)));
  }
  return out;
}

TEST(Progressive, RaysOfAPixelFilterItsTextureTogether) {
  // Rows of texels 32 times as wide as columns: a square of texels that covers a pixel covers
  // many columns, so that a ray alone sees rows blurred.
  constexpr int kColumns = 1024, kRows = 32;
  std::vector<uint8_t> texels;
  for (int row = 0; row < kRows; ++row)
    texels.insert(texels.end(), size_t{3} * kColumns, row % 2 == 0 ? 255 : 40);
  scene::Scene scene;
  scene.textures.push_back(std::make_shared<scene::Texture>(kColumns, kRows, texels, false));
  const int wall = test::add_material(&scene, {1, 1, 1});
  scene.materials.back().base_color_texture.texture = 0;
  test::add_quad(&scene, {-2, -2, 0}, {6, 0, 0}, {0, 6, 0}, wall);
  const Room room(std::move(scene));
  RenderSettings settings;
  settings.indirect = settings.direct = false;
  const image::Image truth = unfiltered_albedo(room.traced, 16);
  const Film one = room.film(*room.gather, settings, passes(1));
  const Film many = room.film(*room.gather, settings, passes(64));
  EXPECT_LT(difference(many.mean(many.albedo), truth), 0.08);
  EXPECT_GT(difference(one.mean(one.albedo), truth), 0.3);
}

TEST(Progressive, TheSameSeedIsTheSameFilmByAnyNumberOfThreads) {
  const Room room(test::furnished_room());
  const auto picture = [&] {
    return make_picture(room.film(*room.gather, {}, passes(kCorrectFrom + 2)),
                        {Output::Full, nullptr, {}});
  };
  set_num_threads(1);
  const Frame one = picture();
  set_num_threads(3);
  const Frame three = picture();
  set_num_threads(0);
  EXPECT_EQ(one.color.pixels, three.color.pixels);
  EXPECT_EQ(one.indirect.pixels, three.indirect.pixels);
}

TEST(Progressive, AFilmGoesOnWhereItEnded) {
  const Room room(test::furnished_room());
  Film twice(kWidth, kHeight);
  render::render(room.traced.view(), *room.gather, camera(), {}, passes(2), &twice);
  render::render(room.traced.view(), *room.gather, camera(), {}, passes(5), &twice);
  const Film once = room.film(*room.gather, {}, passes(5));
  EXPECT_EQ(twice.passes, 5);
  EXPECT_EQ(twice.gathered.mean().indirect.pixels, once.gathered.mean().indirect.pixels);
}

TEST(Progressive, TheHalvesAreIndependent) {
  const Room room(test::furnished_room());
  const Film film = room.film(*room.gather, {}, passes(8));
  const image::Image a = film.gathered.mean_of(0).indirect, b = film.gathered.mean_of(1).indirect;
  RenderSettings many;
  many.rays = 64;
  const image::Image truth = room.film(*room.gather, many, passes(16)).gathered.mean().indirect;
  // The products of their errors cancel where each is as large as the other.
  double product = 0, squares = 0;
  for (size_t k = 0; k < a.pixels.size(); ++k) {
    const double x = double{a.pixels[k]} - double{truth.pixels[k]},
                 y = double{b.pixels[k]} - double{truth.pixels[k]};
    product += x * y;
    squares += (x * x + y * y) / 2;
  }
  EXPECT_LT(std::fabs(product), 0.25 * squares);
}

TEST(Progressive, PathsStandBesideFromTheNinthPassOn) {
  const Room room(test::furnished_room());
  EXPECT_EQ(room.film(*room.gather, {}, passes(kCorrectFrom)).path_passes, 0);
  EXPECT_EQ(room.film(*room.gather, {}, passes(kCorrectFrom + 3)).path_passes, 3);
  RenderSettings settings;
  settings.correct = false;
  EXPECT_EQ(room.film(*room.gather, settings, passes(kCorrectFrom + 3)).path_passes, 0);
}

TEST(Progressive, TimeEndsItAtMostAPassLater) {
  const Room room(test::furnished_room());
  Until until;
  until.seconds = 0;
  EXPECT_EQ(room.film(*room.gather, {}, until).passes, 1) << "never less than one";
  until.seconds = 0.3;
  double longest = 0;
  Timer pass;
  until.pass_done = [&](const Film&, double) {
    longest = std::max(longest, pass.seconds());
    pass.restart();
  };
  const Timer timer;
  EXPECT_GT(room.film(*room.gather, {}, until).passes, 1);
  EXPECT_LT(timer.seconds(), until.seconds + longest + 0.05);
}

TEST(Progressive, StopEndsItWithinAPass) {
  const Room room(test::furnished_room());
  Until until = passes(100);
  int asked = 0;
  until.stop = [&] { return ++asked > 3; };
  EXPECT_LT(room.film(*room.gather, {}, until).passes, 10);
}

TEST(Progressive, ErrorEndsIt) {
  const Room room(test::furnished_room());
  Until until = passes(1000);
  until.error = 0.15;
  RenderSettings settings;
  settings.correct = false;
  const Film film = room.film(*room.gather, settings, until);
  EXPECT_LT(film.passes, 1000);
  EXPECT_LE(film.gathered.relative_error(), until.error);
}

TEST(Progressive, MetalIsPathTraced) {
  scene::Scene scene = test::furnished_room();
  scene.materials[1].metallic = 1;
  scene.materials[1].roughness = 0.5f;
  const Room room(std::move(scene));
  RenderSettings settings;
  settings.correct = false;
  settings.rays = settings.light_samples = 16;
  const Frame frame =
      make_picture(room.film(*room.gather, settings, passes(64)), {Output::Full, nullptr, {}});
  EXPECT_GT(frame.metal_pixels, 20);
  EXPECT_GT(frame.metal, 10);
  const image::Image traced = pathtrace::render_reference(room.traced.bvh, room.traced.lights,
                                                          camera(), kWidth, kHeight, {512, 6, 77});
  EXPECT_NEAR(mean_of(frame.color) / mean_of(traced), 1, 0.02);
}

TEST(Picture, TheLayersAreThePicture) {
  const Room room(test::furnished_room());
  const image::Denoiser denoiser(image::DenoiseBy::Bilateral);
  const Frame frame = make_picture(room.film(*room.gather, {}, passes(kCorrectFrom + 4)),
                                   {Output::Full, &denoiser, image::OidnQuality::Fast});
  for (size_t k = 0; k < frame.color.pixels.size(); ++k) {
    const float sum =
        frame.emission.pixels[k] +
        frame.albedo.pixels[k] / kPi * (frame.direct.pixels[k] + frame.indirect.pixels[k]);
    ASSERT_NEAR(frame.color.pixels[k], sum, 1e-4f + 1e-4f * sum);
  }
}

TEST(Picture, LayersAreNearerToTheTruthThanTheNoisyOnes) {
  const Room room(test::furnished_room());
  const image::Denoiser denoiser(image::DenoiseBy::Bilateral);
  RenderSettings many;
  many.correct = false;
  many.rays = many.light_samples = 64;
  const Frame truth =
      make_picture(room.film(*room.gather, many, passes(8)), {Output::Full, nullptr, {}});
  for (const int count : {2, kCorrectFrom + 2}) {  // without paths and with them
    const Film film = room.film(*room.gather, {}, passes(count));
    const Frame noisy = make_picture(film, {Output::Full, nullptr, {}}),
                smooth = make_picture(film, {Output::Full, &denoiser, image::OidnQuality::High});
    EXPECT_LT(difference(smooth.direct, truth.direct), difference(noisy.direct, truth.direct));
    EXPECT_LT(difference(smooth.indirect, truth.indirect),
              0.7 * difference(noisy.indirect, truth.indirect));
    EXPECT_EQ(smooth.gathered_indirect.pixels, noisy.gathered_indirect.pixels)
        << "as it was gathered";
  }
}

TEST(Picture, WithoutLayersThePictureIsTheSame) {
  const Room room(test::furnished_room());
  const image::Denoiser denoiser(image::DenoiseBy::Bilateral);
  const Film film = room.film(*room.gather, {}, passes(2));
  PictureSettings settings{Output::Full, &denoiser, image::OidnQuality::Fast};
  const image::Image with = make_picture(film, settings).color;
  settings.layers = false;
  const Frame without = make_picture(film, settings);
  EXPECT_TRUE(without.direct.pixels.empty());
  EXPECT_LT(difference(without.color, with), 1e-5);
}

TEST(Picture, DenoisingBringsItNearerToTheTruth) {
  const Room room(test::furnished_room());
  const image::Denoiser denoiser(image::DenoiseBy::Bilateral);
  const Film film = room.film(*room.gather, {}, passes(2));
  const image::Image traced = pathtrace::render_reference(room.traced.bvh, room.traced.lights,
                                                          camera(), kWidth, kHeight, {1024, 6, 77});
  const double noisy = difference(make_picture(film, {Output::Full, nullptr, {}}).color, traced);
  const double smooth = difference(
      make_picture(film, {Output::Full, &denoiser, image::OidnQuality::Fast}).color, traced);
  EXPECT_LT(smooth, noisy);
}

TEST(Progressive, ACountOutOfRangeIsNamed) {
  const Room room(test::furnished_room());
  RenderSettings settings;
  settings.rays = 0;
  Film film(4, 4);
  try {
    render::render(room.traced.view(), *room.gather, camera(), settings, passes(1), &film);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("rays a point must be at least 1, got 0"));
  }
}

}  // namespace
}  // namespace lte::render
