// Spectra to colors, against published values.
#include "lte/scene/pbrt/spectrum.h"

#include <gtest/gtest.h>

#include "tests/scene/expect.h"

namespace lte::scene::pbrt {
namespace {

using test::expect_near;

Spectrum constant(double value) { return {{300, value}, {900, value}}; }

TEST(Spectrum, AWhiteReflectorIsWhite) {
  expect_near(reflectance_to_rgb(constant(1)), {1, 1, 1}, 1e-6f);
  expect_near(reflectance_to_rgb(constant(0.25)), {0.25f, 0.25f, 0.25f}, 1e-6f);
}

TEST(Spectrum, NarrowBandsHaveTheirHue) {
  const Rgb blue = reflectance_to_rgb({{430, 0}, {450, 1}, {470, 0}});
  const Rgb green = reflectance_to_rgb({{520, 0}, {540, 1}, {560, 0}});
  const Rgb red = reflectance_to_rgb({{610, 0}, {630, 1}, {650, 0}});
  EXPECT_GT(blue.z, 10 * blue.y);
  EXPECT_GT(green.y, 10 * green.x);
  EXPECT_GT(red.x, 10 * red.y);
  EXPECT_EQ(reflectance_to_rgb({{900, 1}, {1000, 1}}), (Rgb{0, 0, 0}));
  EXPECT_EQ(illuminant_to_rgb({{900, 1}, {1000, 1}}), (Rgb{0, 0, 0}));
}

TEST(Spectrum, ASumOfReflectancesIsTheSumOfTheirColors) {
  const Rgb low = reflectance_to_rgb({{400, .3}, {700, .1}});
  const Rgb high = reflectance_to_rgb({{400, .2}, {700, .4}});
  expect_near(low + high, reflectance_to_rgb({{400, .5}, {700, .5}}), 1e-5f);
}

/// Chromaticities of the Planckian locus: 2856 K is illuminant A (0.44757, 0.40745); 6504 K lies at
/// (0.3135, 0.3237).
TEST(Spectrum, BlackbodiesHaveTheirChromaticity) {
  expect_near(blackbody_to_rgb(2856), chromaticity_to_rgb(0.44757, 0.40745), 0.02f);
  expect_near(blackbody_to_rgb(6504), chromaticity_to_rgb(0.3135, 0.3237), 0.02f);
  for (const double kelvin : {100.0, 1000.0, 1e6}) {
    const Rgb color = blackbody_to_rgb(kelvin);
    EXPECT_TRUE(is_finite(color)) << kelvin;
    EXPECT_NEAR(luminance(color), 1, 1e-4) << kelvin;
  }
}

TEST(Spectrum, NamedIlluminants) {
  expect_near(*named_illuminant("stdillum-D65"), {1, 1, 1}, 2e-3f);
  EXPECT_GT(named_illuminant("stdillum-A")->x, 1.5f);
  EXPECT_LT(named_illuminant("stdillum-A")->z, 0.5f);
  for (const char* name : {"stdillum-F1", "stdillum-F12", "illum-acesD60", "stdillum-D50"})
    EXPECT_NEAR(luminance(*named_illuminant(name)), 1, 1e-5) << name;
  EXPECT_FALSE(named_illuminant("stdillum-X"));
}

/// By hand: n = 1, k = 2 reflects 4 / (4 + 4) = 1/2; n = 3, k = 0 reflects (2/4)² = 1/4.
TEST(Spectrum, ConductorsReflectByFresnel) {
  EXPECT_NEAR(conductor_reflectance(1, 2), 0.5, 1e-12);
  expect_near(conductor_to_rgb(constant(1), constant(2)), {.5f, .5f, .5f}, 1e-6f);
  expect_near(conductor_to_rgb({{500, 3}}, {{500, 0}}), {.25f, .25f, .25f}, 1e-6f);
}

/// n and k of copper at a few wavelengths (Johnson and Christy 1972) give the color of the table,
/// which comes from another measurement (1982, Palik): copper's edge differs by a few percent.
TEST(Spectrum, TableOfMetalsAgreesWithOtherMeasurements) {
  const Spectrum eta{{397, 1.18}, {431, 1.18}, {471, 1.15}, {521, 1.12}, {549, 1.02},
                     {582, 0.70}, {617, 0.30}, {660, 0.22}, {705, 0.21}};
  const Spectrum k{{397, 2.21}, {431, 2.21}, {471, 2.50}, {521, 2.60}, {549, 2.58},
                   {582, 2.70}, {617, 3.21}, {660, 3.75}, {705, 4.21}};
  expect_near(*named_conductor("Cu"), conductor_to_rgb(eta, k), 0.04f);
  EXPECT_FALSE(named_conductor("Unobtainium"));
}

}  // namespace
}  // namespace lte::scene::pbrt
