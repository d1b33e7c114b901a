#include "infer/renderer/kept_views.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lte/base/check.h"

namespace lte::infer {
namespace {

/// Points of a view that stand for so many times what is asked about would blur.
constexpr float kWidest = 1.5f;
/// The part of the four points around a place that must lie on its surface.
constexpr float kLeastShare = 0.3f;
/// What was taken no more often is good enough to look no further.
constexpr uint8_t kFewSteps = 2;
/// KeptView::steps of what has no light.
constexpr uint8_t kNoLight = 255;

/// Two neighbours of a grid around a place along one of its axes.
struct Between {
  int before = 0, after = 0;
  float share = 0;  ///< of the second
};

/// @param place  in pixels: 0.5 is the centre of the first
std::optional<Between> between(const gi::GridAxis& axis, float place) {
  const float at = place - 0.5f;
  if (!(at >= -0.5f && at <= static_cast<float>(axis.last) + 0.5f)) return std::nullopt;
  Between out;
  const auto cell = static_cast<int>(at * (1 / static_cast<float>(axis.step)));
  out.before = std::clamp(cell, 0, std::max(0, axis.count() - 2));
  out.after = std::min(out.before + 1, axis.count() - 1);
  const int first = axis.at(out.before), last = axis.at(out.after);
  if (last > first)
    out.share =
        std::clamp((at - static_cast<float>(first)) / static_cast<float>(last - first), 0.0f, 1.0f);
  return out;
}

/// @param most  steps of which what is taken must have fewer
std::optional<KeptViews::Found> find_in(const KeptView& view, const gi::SurfacePoint& point,
                                        float extent, int most) {
  const auto place = view.projection.place(point.position);
  if (!place) return std::nullopt;
  const float here = place->depth * view.pixel_size * static_cast<float>(view.columns.step);
  if (here > kWidest * extent) return std::nullopt;
  const auto x = between(view.columns, place->x);
  const auto y = between(view.rows, place->y - static_cast<float>(view.first_row));
  if (!x || !y) return std::nullopt;
  const gi::PixelSurfaces surfaces = view.surfaces();
  KeptViews::Found out{&view, {}, 0};
  out.around.pixel = {surfaces.at(x->before, y->before), surfaces.at(x->after, y->before),
                      surfaces.at(x->before, y->after), surfaces.at(x->after, y->after)};
  out.around.weight = {(1 - x->share) * (1 - y->share), x->share * (1 - y->share),
                       (1 - x->share) * y->share, x->share * y->share};
  out.around.count = 4;
  // A byte each, before all that a point has: most views have nothing better than is known.
  const auto steps = [&](size_t k) { return view.steps[out.around.pixel[k]]; };
  if (std::min({steps(0), steps(1), steps(2), steps(3)}) >= most) return std::nullopt;
  float on_surface = 0, sum = 0;
  // The depth that the view sees the point at: what limits how far off its plane others may lie.
  const gi::SurfacePoint seen{point.position, point.normal, place->depth};
  for (size_t k = 0; k < 4; ++k) {
    const size_t source = out.around.pixel[k];
    float& weight = out.around.weight[k];
    const float alike = view.steps[source] != kNoLight ? gi::similarity(surfaces, seen, source) : 0;
    if (!(weight * alike > 0)) {
      weight = 0;
      continue;
    }
    on_surface += weight * alike;
    // Over a plane 1/depth and irradiance/depth are linear in the picture.
    weight *= alike / view.depth[source];
    sum += weight;
    out.steps = std::max(out.steps, view.steps[source]);
  }
  if (!(on_surface >= kLeastShare) || out.steps >= most) return std::nullopt;
  for (float& weight : out.around.weight) weight /= sum;
  ++out.steps;
  return out;
}

}  // namespace

bool KeptKind::serves(const KeptKind& wanted) const {
  return direct == wanted.direct && indirect == wanted.indirect && sum == wanted.sum &&
         gather_rays >= wanted.gather_rays && shadow_rays >= wanted.shadow_rays;
}

KeptView::KeptView(const Projection& picture, int top_row, const gi::GridAxis& grid_columns,
                   const gi::GridAxis& grid_rows, float size_of_pixel)
    : projection(picture),
      first_row(top_row),
      columns(grid_columns),
      rows(grid_rows),
      pixel_size(size_of_pixel) {
  const size_t count = static_cast<size_t>(columns.count()) * static_cast<size_t>(rows.count());
  position.resize(count);
  normal.resize(count);
  depth.resize(count);
  mask.resize(count);
  steps.resize(count);
}

gi::PixelSurfaces KeptView::surfaces() const {
  gi::PixelSurfaces out;
  out.width = columns.count();
  out.height = rows.count();
  out.position = position;
  out.normal = normal;
  out.depth = depth;
  out.mask = mask;
  out.pixel_size = pixel_size;
  return out;
}

KeptViews::KeptViews(int64_t most) : most_(most) {
  LTE_CHECK(most >= 0, "kept views: expected a number of points that is not negative, got ", most);
}

void KeptViews::add(KeptView view) {
  points_ += static_cast<int64_t>(view.size());
  for (size_t i = 0; i < view.size(); ++i) {
    if (!view.mask[i]) view.steps[i] = kNoLight;
  }
  views_.push_back(std::move(view));
  while (views_.size() > 1 && points_ - static_cast<int64_t>(views_.front().size()) >= most_) {
    points_ -= static_cast<int64_t>(views_.front().size());
    views_.pop_front();
  }
}

Rgb KeptViews::Found::value(size_t layer) const {
  Rgb sum;
  for (size_t k = 0; k < 4; ++k) {
    if (around.weight[k] > 0) sum += view->values[layer][around.pixel[k]] * around.weight[k];
  }
  return sum;
}

std::optional<KeptViews::Found> KeptViews::find(const gi::SurfacePoint& point, float extent,
                                                const KeptKind& kind, int* hint) const {
  std::optional<Found> best;
  const auto look = [&](int index) {
    const KeptView& view = views_[static_cast<size_t>(index)];
    if (!view.kind.serves(kind)) return false;
    const auto found = find_in(view, point, extent, best ? best->steps - 1 : kMostKeptSteps);
    if (!found) return false;
    best = found;
    *hint = index;
    return best->steps <= kFewSteps;
  };
  const int first = *hint;
  *hint = -1;
  if (first >= 0 && first < static_cast<int>(views_.size()) && look(first)) return best;
  for (int index = static_cast<int>(views_.size()) - 1; index >= 0; --index) {
    if (index != first && look(index)) break;
  }
  return best;
}

}  // namespace lte::infer
