#include "datagen/wild/ceiling.h"

#include <algorithm>
#include <cmath>

namespace lte::datagen::wild {
namespace {

struct Span {
  float low = INFINITY, high = -INFINITY;
};

Span span_of(const Polygon& outline, const Vec2& along) {
  Span span;
  for (const Vec2& p : outline) {
    span.low = std::min(span.low, dot(p, along));
    span.high = std::max(span.high, dot(p, along));
  }
  return span;
}

/// How far `p` is from the centre, over the outline in that direction: 0 to 1.
float gauge(const Polygon& outline, const Vec2& p) {
  const Vec2 centre = centre_of(outline);
  float most = 0;
  for (size_t i = 0; i < outline.size(); ++i) {
    const Edge edge = edge_of(outline, i);
    most =
        std::max(most, 1 - dot(p - edge.from, edge.inward) / dot(centre - edge.from, edge.inward));
  }
  return most;
}

std::vector<Vec3> lifted(const Polygon& part, const Cell& cell) {
  std::vector<Vec3> out;
  for (const Vec2& p : part)
    out.push_back(in_space(p, height_on(cell.ceiling.profile, dot(p, cell.ceiling.along))));
  return out;
}

std::vector<Vec3> ring_at(const Cell& cell, const Vec2& ring) {
  const Vec2 centre = centre_of(cell.outline);
  std::vector<Vec3> out;
  for (const Vec2& p : cell.outline)
    out.push_back(in_space(centre + (p - centre) * ring.x, ring.y));
  return out;
}

}  // namespace

Ceiling make_ceiling(CeilingKind kind, const Polygon& outline, float eaves, Dice* dice) {
  Ceiling out;
  out.kind = kind;
  out.eaves = eaves;
  const Edge edge = edge_of(outline, dice->rng.below(outline.size()));
  out.along = edge.inward;
  const Span span = span_of(outline, out.along);
  const float width = span.high - span.low, rise = width * dice->draw(0.15f, 0.6f);
  const auto add = [&](float t, float y) {
    out.profile.push_back({span.low + t * width, eaves + y * rise});
  };
  if (kind == CeilingKind::Tent || kind == CeilingKind::Dome) {
    const int rings = kind == CeilingKind::Tent ? 1 : 5;
    for (int i = 0; i <= rings; ++i) {
      const float t = static_cast<float>(i) / static_cast<float>(rings);
      out.rings.push_back({std::cos(t * kPi / 2), eaves + rise * std::sin(t * kPi / 2)});
    }
    out.rings.back().x = 0;
  } else if (kind == CeilingKind::Shed) {
    add(0, 0);
    add(1, 1);
  } else if (kind == CeilingKind::Gable) {
    const float ridge = dice->chance(0.6f) ? 0.5f : dice->draw(0.2f, 0.8f);
    add(0, 0);
    add(ridge, 1);
    add(1, dice->chance(0.7f) ? 0 : dice->draw(0, 0.6f));
  } else if (kind == CeilingKind::Vault) {
    constexpr int kSteps = 10;
    for (int i = 0; i <= kSteps; ++i) {
      const float a = kPi * static_cast<float>(i) / kSteps;
      add(0.5f - 0.5f * std::cos(a), i == kSteps ? 0 : std::sin(a));
    }
  } else {
    add(0, 0);
    add(1, 0);
  }
  return out;
}

std::vector<std::vector<Vec3>> facets(const Cell& cell) {
  std::vector<std::vector<Vec3>> out;
  const Ceiling& ceiling = cell.ceiling;
  for (size_t k = 0; k + 1 < ceiling.profile.size(); ++k) {
    const float low = k == 0 ? -INFINITY : ceiling.profile[k].x,
                high = k + 2 == ceiling.profile.size() ? INFINITY : ceiling.profile[k + 1].x;
    const Polygon part = band(cell.outline, ceiling.along, low, high);
    if (part.size() >= 3) out.push_back(lifted(part, cell));
  }
  for (size_t k = 0; k + 1 < ceiling.rings.size(); ++k) {
    const std::vector<Vec3> outer = ring_at(cell, ceiling.rings[k]),
                            inner = ring_at(cell, ceiling.rings[k + 1]);
    for (size_t i = 0; i < outer.size(); ++i) {
      const size_t j = (i + 1) % outer.size();
      if (ceiling.rings[k + 1].x > 0) {
        out.push_back({outer[i], outer[j], inner[j], inner[i]});
      } else {
        out.push_back({outer[i], outer[j], inner[i]});
      }
    }
  }
  return out;
}

float height_on(const std::vector<Vec2>& line, float x) {
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    if (x > line[i + 1].x && i + 2 < line.size()) continue;
    const float t = (x - line[i].x) / std::max(line[i + 1].x - line[i].x, 1e-9f);
    return line[i].y + std::clamp(t, 0.0f, 1.0f) * (line[i + 1].y - line[i].y);
  }
  return line.front().y;
}

float Cell::height_at(const Vec2& p) const {
  if (!ceiling.profile.empty()) return height_on(ceiling.profile, dot(p, ceiling.along));
  const float x = gauge(outline, p);
  for (size_t k = 0; k + 1 < ceiling.rings.size(); ++k) {
    const Vec2 &outer = ceiling.rings[k], &inner = ceiling.rings[k + 1];
    if (x < inner.x) continue;
    const float t = std::clamp((outer.x - x) / (outer.x - inner.x), 0.0f, 1.0f);
    return outer.y + t * (inner.y - outer.y);
  }
  return ceiling.rings.back().y;
}

std::vector<Vec2> Cell::top_of(size_t index) const {
  const Edge edge = edge_of(outline, index);
  if (ceiling.profile.empty()) return {{0, ceiling.eaves}, {edge.length, ceiling.eaves}};
  const float from = dot(edge.from, ceiling.along), slope = dot(edge.along, ceiling.along);
  std::vector<Vec2> out{{0, height_on(ceiling.profile, from)}};
  for (const Vec2& knot : ceiling.profile) {
    const float u = std::abs(slope) > 1e-5f ? (knot.x - from) / slope : -1;
    if (u > 1e-4f && u < edge.length - 1e-4f) out.push_back({u, knot.y});
  }
  out.push_back({edge.length, height_on(ceiling.profile, dot(edge.to, ceiling.along))});
  std::sort(out.begin(), out.end(), [](const Vec2& a, const Vec2& b) { return a.x < b.x; });
  return out;
}

}  // namespace lte::datagen::wild
