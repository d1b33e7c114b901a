#include "infer/render/quality.h"

#include <charconv>
#include <cmath>

#include "lte/base/check.h"
#include "lte/base/text.h"

namespace lte::infer {
namespace {

/// Share of the pixels that lie at edges, where several hits are traced, in rooms with furniture.
constexpr double kEdgeShare = 0.15;
/// Room for what predictions leave out, as a share of the prediction.
constexpr double kSlack = 0.15;

}  // namespace

QualitySettings quality_settings(Quality quality) {
  QualitySettings out;
  switch (quality) {
    case Quality::Draft:
      out.direct_samples = 4;
      out.antialias = 0;
      out.sparse = true;
      out.answers.tolerance = 0.2f;
      out.answers.contact_radius = -1;
      out.answered_share = 0.05;
      out.gather = {8, 2, image::OidnQuality::Fast, /*direct=*/true};
      out.large_step = 4;
      out.large_rays = 6;
      out.gather_direct_samples = 8;
      out.gather_antialias = 8;
      break;
    case Quality::Preview:
      out.direct_samples = 16;
      out.antialias = 4;
      out.sparse = true;
      out.answers.tolerance = 0.1f;
      out.answers.contact_radius = -1;
      out.answered_share = 0.1;
      out.gather = {16, 2, image::OidnQuality::Balanced};
      out.gather_direct_samples = out.direct_samples;
      out.gather_antialias = kAntialias;
      break;
    case Quality::Final:
      out.direct_samples = RenderSettings().direct_samples;
      out.antialias = kAntialias;
      out.sparse = false;
      out.answered_share = 0.2;
      out.gather = {32, 2, image::OidnQuality::High};
      out.correction_paths = 8;
      out.gather_direct_samples = out.direct_samples;
      out.gather_antialias = kAntialias;
      break;
  }
  return out;
}

std::string seconds_text(double seconds) { return formatted("%.2f s", seconds); }

double parse_time_budget(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  const std::string unit(at, end);
  const bool known = error == std::errc() && (unit == "s" || unit == "ms");
  LTE_CHECK(known && std::isfinite(value) && value > 0, "\"", text,
            "\": expected a time such as 0.5s or 200ms");
  return unit == "s" ? value : value / 1000;
}

double predicted_seconds(const QualitySettings& settings, const PictureRates& rates,
                         int64_t pixels) {
  const double hits = 1 + kEdgeShare * settings.antialias;
  const double answers = settings.sparse ? settings.answered_share : 1;
  return static_cast<double>(pixels) *
         (rates.primary_s * hits + rates.decode_s * answers + rates.metal_s +
          rates.ray_s * settings.direct_samples) *
         (1 + kSlack);
}

Quality choose_quality(double seconds, double spent, const PictureRates& rates, int64_t pixels,
                       const std::array<QualitySettings, 3>& settings, bool rays_are_given) {
  for (const Quality quality : {Quality::Final, Quality::Preview}) {
    if (predicted_seconds(settings[static_cast<size_t>(quality)], rates, pixels) <= seconds)
      return quality;
  }
  QualitySettings least = settings[static_cast<size_t>(Quality::Draft)];
  if (!rays_are_given) least.direct_samples = 1;
  const double need = predicted_seconds(least, rates, pixels);
  LTE_CHECK(need <= seconds, "--time-budget: ", seconds_text(std::max(0.0, seconds)),
            " are left after ", seconds_text(spent),
            " for scene points and encoding, and the quickest picture takes about ",
            seconds_text(need), ": expected ", seconds_text(spent + need), " or more");
  return Quality::Draft;
}

}  // namespace lte::infer
