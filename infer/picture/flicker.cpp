#include "infer/picture/flicker.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "infer/picture/projection.h"
#include "lte/base/check.h"

namespace lte::infer {
namespace {

using image::Image;

/// The light at a place, between the four pixels around it, if these see a surface at this depth.
/// Over a plane the inverse of depth is linear in the picture.
std::optional<Rgb> light_at(const FlickerFrame& frame, const Projection::Place& place) {
  const float x = place.x - 0.5f, y = place.y - 0.5f;
  const Image& depth = frame.depth;
  if (!(x >= 0 && y >= 0 && x <= static_cast<float>(depth.width - 1) &&
        y <= static_cast<float>(depth.height - 1)))
    return std::nullopt;
  const int left = std::min(static_cast<int>(x), std::max(0, depth.width - 2)),
            top = std::min(static_cast<int>(y), std::max(0, depth.height - 2));
  const float right = x - static_cast<float>(left), below = y - static_cast<float>(top);
  Rgb sum{};
  float inverse_depth = 0;
  for (int i = 0; i < 4; ++i) {
    const int px = std::min(left + i % 2, depth.width - 1),
              py = std::min(top + i / 2, depth.height - 1);
    const float here = *depth.at(px, py);
    if (!(std::abs(here - place.depth) <= kDepthJump * place.depth)) return std::nullopt;
    const float weight = (i % 2 ? right : 1 - right) * (i / 2 ? below : 1 - below);
    sum += frame.light.rgb(px, py) * weight;
    inverse_depth += weight / here;
  }
  if (!(std::abs(1 / inverse_depth - place.depth) <= kDepthTolerance * place.depth))
    return std::nullopt;
  return sum;
}

/// Both values of the points of `from` that `to` shows too; nothing for the others.
struct Pair {
  Rgb before, after;
};
std::vector<std::optional<Pair>> pairs_of(const FlickerFrame& from, const FlickerFrame& to) {
  const int width = from.depth.width, height = from.depth.height;
  const Projection here(from.camera, width, height), there(to.camera, width, height);
  std::vector<std::optional<Pair>> pairs(static_cast<size_t>(width) * static_cast<size_t>(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float depth = *from.depth.at(x, y);
      if (!(depth > 0)) continue;
      const auto place = there.place(
          here.point(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, depth));
      if (!place) continue;
      if (const std::optional<Rgb> after = light_at(to, *place))
        pairs[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)] =
            Pair{from.light.rgb(x, y), *after};
    }
  }
  return pairs;
}

double square(const Rgb& v) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += double{v[c]} * double{v[c]};
  return sum;
}

/// Sums over points and channels.
struct Sums {
  double level = 0, change = 0;

  void add(const Pair& pair) {
    const Rgb both = pair.before + pair.after;
    level += 0.5 * (double{both.x} + double{both.y} + double{both.z});
    change += square(pair.after - pair.before);
  }
};

void check_frames(std::span<const FlickerFrame> frames, const FlickerFrame& like,
                  const char* what) {
  for (size_t i = 0; i < frames.size(); ++i) {
    const FlickerFrame& frame = frames[i];
    LTE_CHECK(frame.light.channels == 3 && frame.depth.channels == 1, what, " ", i,
              ": expected 3 channels of light and 1 of depth, got ", frame.light.channels, " and ",
              frame.depth.channels);
    LTE_CHECK(frame.light.width == like.depth.width && frame.light.height == like.depth.height &&
                  frame.depth.width == like.depth.width && frame.depth.height == like.depth.height,
              what, " ", i, ": is ", frame.light.width, "x", frame.light.height, ", expected ",
              like.depth.width, "x", like.depth.height);
  }
}

bool same_view(const scene::Camera& a, const scene::Camera& b) {
  return a.origin == b.origin && a.target == b.target && a.up == b.up && a.vfov == b.vfov &&
         a.mirrored == b.mirrored;
}

}  // namespace

Flicker measure_flicker(std::span<const FlickerFrame> frames,
                        std::span<const FlickerFrame> reference) {
  LTE_CHECK(frames.size() >= 2, "flicker is measured between two frames or more, got ",
            frames.size());
  LTE_CHECK(reference.empty() || reference.size() == frames.size(), "expected ", frames.size(),
            " frames of the reference, one each, got ", reference.size());
  check_frames(frames, frames[0], "frame");
  check_frames(reference, frames[0], "reference frame");
  for (size_t i = 0; i < reference.size(); ++i)
    LTE_CHECK(same_view(frames[i].camera, reference[i].camera), "reference frame ", i,
              ": has another camera than the frame");
  Flicker out;
  Sums own, truth;
  double excess = 0;
  for (size_t i = 0; i + 1 < frames.size(); ++i) {
    const auto pairs = pairs_of(frames[i], frames[i + 1]);
    std::vector<std::optional<Pair>> true_pairs;
    if (!reference.empty()) true_pairs = pairs_of(reference[i], reference[i + 1]);
    out.pixels += static_cast<int64_t>(pairs.size());
    for (size_t p = 0; p < pairs.size(); ++p) {
      if (!pairs[p] || (!reference.empty() && !true_pairs[p])) continue;
      ++out.compared;
      own.add(*pairs[p]);
      if (reference.empty()) continue;
      truth.add(*true_pairs[p]);
      excess += square((pairs[p]->after - pairs[p]->before) -
                       (true_pairs[p]->after - true_pairs[p]->before));
    }
  }
  const double values = 3 * static_cast<double>(std::max<int64_t>(1, out.compared));
  const auto relative = [&](double squares, double level) {
    return level > 0 ? std::sqrt(squares / values) / (level / values) : 0;
  };
  out.level = own.level / values;
  out.change = relative(own.change, own.level);
  out.reference_change = relative(truth.change, truth.level);
  out.excess = relative(excess, truth.level);
  return out;
}

}  // namespace lte::infer
