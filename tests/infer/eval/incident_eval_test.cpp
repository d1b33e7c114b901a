#include "infer/eval/incident/incident_eval.h"

#include <cmath>
#include <numbers>

#include <ATen/ATen.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "infer/eval/incident/incident_page.h"
#include "lte/base/check.h"
#include "lte/base/half.h"
#include "lte/base/random.h"
#include "lte/pathtrace/incident/hemisphere_bins.h"
#include "tests/infer/fixture.h"

namespace lte::infer {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Vec3 random_direction(Rng* rng) {
  const float z = rng->uniform(-1, 1), azimuth = 2 * kPi * rng->uniform();
  const float across = std::sqrt(1 - z * z);
  return {across * std::cos(azimuth), across * std::sin(azimuth), z};
}

TEST(SphericalHarmonics, AreOrthonormalOverTheSphere) {
  constexpr int kDegree = 6, kCount = 49, kRows = 64, kColumns = 64;
  std::vector<double> gram(kCount * kCount);
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {  // midpoints in azimuth, Fejér's in z
      const double theta = std::numbers::pi * (row + 0.5) / kRows;
      const double azimuth = 2 * std::numbers::pi * (column + 0.5) / kColumns;
      const auto Y =
          spherical_harmonics(kDegree, {static_cast<float>(std::sin(theta) * std::cos(azimuth)),
                                        static_cast<float>(std::sin(theta) * std::sin(azimuth)),
                                        static_cast<float>(std::cos(theta))});
      const double area =
          std::sin(theta) * std::numbers::pi / kRows * 2 * std::numbers::pi / kColumns;
      for (size_t i = 0; i < kCount; ++i) {
        for (size_t j = 0; j < kCount; ++j) gram[i * kCount + j] += area * Y[i] * Y[j];
      }
    }
  }
  for (size_t i = 0; i < kCount; ++i) {
    for (size_t j = 0; j < kCount; ++j)
      EXPECT_NEAR(gram[i * kCount + j], i == j ? 1 : 0, 2e-3) << i << ", " << j;
  }
}

TEST(SphericalHarmonics, AddUpToLegendrePolynomials) {
  Rng rng(3);
  for (int trial = 0; trial < 10; ++trial) {
    const Vec3 a = random_direction(&rng), b = random_direction(&rng);
    const auto Ya = spherical_harmonics(20, a), Yb = spherical_harmonics(20, b);
    for (int l = 0; l <= 20; ++l) {
      double sum = 0;
      for (int m = -l; m <= l; ++m) {
        const auto at = static_cast<size_t>(l * (l + 1) + m);
        sum += Ya[at] * Yb[at];
      }
      const double expected = (2 * l + 1) / (4 * std::numbers::pi) *
                              std::legendre(static_cast<unsigned>(l), double{dot(a, b)});
      EXPECT_NEAR(sum, expected, 1e-4) << "l = " << l;
    }
  }
}

struct Cells {
  std::vector<Vec3> direction;
  std::vector<double> solid_angle;

  explicit Cells(int bins) {
    for (int row = 0; row < bins; ++row) {
      for (int column = 0; column < bins; ++column) {
        const auto centre = [bins](int cell) {
          return (static_cast<float>(cell) + 0.5f) / static_cast<float>(bins);
        };
        direction.push_back(pathtrace::bin_direction({centre(column), centre(row)}));
        solid_angle.push_back(pathtrace::bin_solid_angle(bins, row, column));
      }
    }
  }
  at::Tensor table(const std::function<double(const Vec3&)>& value) const {
    at::Tensor out = at::empty({static_cast<int64_t>(direction.size()), 1}, at::kDouble);
    for (size_t i = 0; i < direction.size(); ++i) out.data_ptr<double>()[i] = value(direction[i]);
    return out;
  }
  double error(int degree, HarmonicFit fit, const at::Tensor& table) const {
    const HarmonicFitter fitter(degree, fit, direction, solid_angle);
    return (fitter.reconstruct(table) - table).square().mean().item<double>();
  }
};

TEST(HarmonicFitter, LeastSquaresHoldWhatTheyCanAndFallWithTheDegree) {
  const Cells cells(16);
  const at::Tensor cubic =
      cells.table([](const Vec3& d) { return 1 + d.x - 2 * d.y * d.z + d.x * d.x * d.z; });
  EXPECT_GT(cells.error(2, HarmonicFit::LeastSquares, cubic), 1e-4);
  EXPECT_LT(cells.error(3, HarmonicFit::LeastSquares, cubic), 1e-10);
  const at::Tensor step = cells.table([](const Vec3& d) { return d.x > 0.2f ? 1 : 0; });
  double before = INFINITY;
  for (const int degree : {0, 1, 2, 4, 8}) {
    const double error = cells.error(degree, HarmonicFit::LeastSquares, step);
    EXPECT_LT(error, before);
    EXPECT_LE(error, cells.error(degree, HarmonicFit::Projected, step) + 1e-12);
    before = error;
  }
}

TEST(HarmonicFitter, ProjectionsOverTheHemisphereRingAndAWindowDampsIt) {
  const Cells cells(16);
  // A small bright spot: what is far from it should stay dark.
  const at::Tensor spot = cells.table([](const Vec3& d) { return d.z > 0.95f ? 10 : 0; });
  const auto lowest = [&](HarmonicFit fit) {
    return HarmonicFitter(8, fit, cells.direction, cells.solid_angle)
        .reconstruct(spot)
        .min()
        .item<double>();
  };
  EXPECT_LT(lowest(HarmonicFit::Projected), -0.3);
  EXPECT_GT(lowest(HarmonicFit::Windowed), 0.5 * lowest(HarmonicFit::Projected));
}

class IncidentEval : public testing::Test {
 protected:
  void write(bool incident, int64_t lobes) {
    std::filesystem::create_directories(folder_ / "data" / "scenes");
    data::DatasetInfo info;
    info.tool_version = "test";
    info.scale = 16;
    for (const char* name : {"test0", "test1"}) {
      data::SceneSample sample = test::random_sample(name, 3 + info.scenes.size());
      if (incident) test::add_random_incident(&sample, 5, 7);
      data::write_scene_sample(data::scene_path(folder_ / "data", name), sample);
      info.scenes.push_back(
          {name, data::Split::Test, 1, sample.scene_points(), sample.query_points()});
    }
    data::write_dataset_info(folder_ / "data", info);
    test::save_tiny_model(folder_ / "model.safetensors",
                          {.radiance_lobes = lobes, .gloss = lobes > 0, .even_radiance = even_});
  }
  IncidentResult evaluate(const std::string& traced = "") {
    IncidentSettings settings;
    settings.data = folder_ / "data";
    settings.highest_degree = 3;
    settings.lobes = {2, 8, 32};
    if (!traced.empty()) settings.traced = folder_ / traced;
    return evaluate_incident(settings, runtime::Network(folder_ / "model.safetensors"));
  }

  test::TempDir folder_;
  std::optional<double> even_;
};

TEST_F(IncidentEval, ErrorsAreTheirFormulas) {
  even_ = 0.3;  // softplus of it is what π L over the emission scale is, everywhere
  write(true, 4);
  const IncidentResult result = evaluate("data");
  EXPECT_EQ(result.scenes, 2);
  EXPECT_EQ(result.points, 10);
  EXPECT_EQ(result.cells, 16);
  EXPECT_EQ(result.traced.mse, 0) << "the rival is the reference itself";
  EXPECT_EQ(result.traced_paths, 3);
  double logrel = 0, log_mse = 0, mse = 0;
  for (const uint64_t seed : {3, 4}) {
    data::SceneSample sample = test::random_sample("", seed);
    test::add_random_incident(&sample, 5, 7);
    // Mean emission by channel, weighted by area, and over the channels.
    double emission[3] = {}, area = 0;
    for (size_t i = 0; i < sample.scene_area.size(); ++i) {
      area += sample.scene_area[i];
      for (int c = 0; c < 3; ++c)
        emission[c] += double{sample.scene_area[i]} * sample.scene_emission[i][c];
    }
    const double mean = (emission[0] + emission[1] + emission[2]) / 3 / area;
    const size_t per_group = 5 * 16 * 3;
    for (size_t i = 0; i < per_group; ++i) {
      const double scale = sample.incident.scale[i / 48];
      const double y = std::numbers::pi * scale / mean *
                       (double{to_float(sample.incident.indirect[i])} +
                        to_float(sample.incident.indirect[per_group + i]));
      const double x = std::log1p(std::exp(0.3)) * emission[i % 3] / area / mean;
      const double off = (std::log1p(x) - std::log1p(y)) / (std::log1p(y) + kMapEpsilon);
      logrel += off * off / (2 * per_group);
      log_mse += std::pow(std::log1p(x) - std::log1p(y), 2) / (2 * per_group);
      mse += (x - y) * (x - y) / (2 * per_group);
    }
  }
  EXPECT_NEAR(result.neural.logrel, logrel, 1e-4 * logrel);
  EXPECT_NEAR(result.neural.log_mse, log_mse, 1e-4 * log_mse);
  EXPECT_NEAR(result.neural.mse, mse, 1e-4 * mse);
  EXPECT_FALSE(result.casts_rays);
  // A constant of each map alone is no worse than one of all maps.
  for (const HarmonicErrors& h : result.harmonics) {
    if (h.fit == HarmonicFit::LeastSquares) {
      EXPECT_LT(h.errors.mse, mse);
    }
  }
  EXPECT_EQ(result.harmonics.size(), 12u);
  const auto json = nlohmann::json::parse(incident_json(result, "m", "d"));
  EXPECT_EQ(json["harmonics"]["windowed"].size(), 4u);
  EXPECT_EQ(json["harmonics"]["windowed"][2]["coefficients"], 9);
  ASSERT_EQ(result.gaussians.size(), 6u);
  EXPECT_LT(result.gaussians[5].errors.mse, result.gaussians[3].errors.mse)
      << "32 lobes where the map needs them, and 2";
  EXPECT_LT(result.gaussians[5].errors.mse, mse);
  EXPECT_EQ(json["gaussians"]["lattice"][1]["lobes"], 8);
  EXPECT_EQ(json["gaussians"]["lattice"][1]["numbers"], 24);
  EXPECT_EQ(json["gaussians"]["greedy"][1]["numbers"], 48);
  EXPECT_EQ(json["harmonics"]["windowed"][2]["numbers"], 27) << "a lattice of 9 lobes has as many";
  EXPECT_THAT(incident_table(result), AllOf(HasSubstr("neural"), HasSubstr("l <= 2, projected"),
                                            HasSubstr("gaussians, 8, greedy")));
}

TEST_F(IncidentEval, ItsPageHasChartsAndTheMapsOfAPointAScene) {
  even_ = 0.3;
  write(true, 4);
  const IncidentResult result = evaluate("data");
  ASSERT_EQ(result.pictures.size(), 2u);
  const MapRow& row = result.pictures.front();
  ASSERT_EQ(row.maps.size(), 4u) << "no degree as high as those shown was fitted";
  EXPECT_EQ(row.maps[3].first, "32 Gaussians greedy") << "192 numbers";
  EXPECT_EQ(row.maps[0].first, "reference");
  EXPECT_EQ(row.maps[1].first, "network");
  EXPECT_TRUE(at::equal(row.maps[0].second, row.maps[2].second)) << "the rival is the reference";
  const at::Tensor& network = row.maps[1].second;
  EXPECT_EQ(network.sizes(), (std::vector<int64_t>{16, 3}));
  EXPECT_TRUE(at::equal(std::get<0>(network.min(0)), std::get<0>(network.max(0))))
      << "it answers the same everywhere";
  const std::string page = incident_html(result, "the model", "the data");
  EXPECT_THAT(page, AllOf(HasSubstr("<svg"), HasSubstr("harmonics, windowed"),
                          HasSubstr("Gaussians, lattice"), HasSubstr("At equal storage"),
                          HasSubstr("data:image/png;base64,"), HasSubstr("the model"),
                          HasSubstr("reference | network | traced, 3 paths")));
}

TEST_F(IncidentEval, RefusesModelsWithoutADecoderAndScenesWithoutMaps) {
  const auto message = [&] {
    try {
      evaluate();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  write(true, 0);
  EXPECT_THAT(message(), HasSubstr("no radiance decoder"));
  write(false, 4);
  EXPECT_THAT(message(), AllOf(HasSubstr("test0"), HasSubstr("no incident radiance")));
}

}  // namespace
}  // namespace lte::infer
