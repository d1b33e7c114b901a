#include "lte/pathtrace/lights/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace lte::pathtrace {
namespace {

constexpr int kBuckets = 12;
constexpr int kMaxCostDepth = 32;  // deeper, splits halve: a trail of 64 bits holds any tree

float sine(float cosine) { return std::sqrt(std::max(0.0f, 1 - cosine * cosine)); }

/// A number of each of two clusters. The upper half repeats the lower one: what is worked out there
/// is not looked at.
using Pair = float __attribute__((vector_size(16)));
using PairOfFlags = int32_t __attribute__((vector_size(16)));

Pair both(float x) { return Pair{x, x, x, x}; }
Pair load(const float (&of)[2]) { return Pair{of[0], of[1], of[0], of[1]}; }
PairOfFlags load(const int32_t (&of)[2]) { return PairOfFlags{of[0], of[1], of[0], of[1]}; }
Pair largest(const Pair& a, const Pair& b) { return a < b ? b : a; }
Pair within_one(const Pair& x) {
  const Pair above = x < -both(1) ? -both(1) : x;
  return both(1) < above ? both(1) : above;
}
Pair root(const Pair& x) {
#if defined(__SSE2__)
  return _mm_sqrt_ps(x);
#else
  return Pair{std::sqrt(x[0]), std::sqrt(x[1]), 0, 0};
#endif
}
Pair root_of_positive(const Pair& x) { return root(largest(both(0), x)); }
Pair sines(const Pair& cosine) { return root_of_positive(1 - cosine * cosine); }

Vec3 rotated(const Vec3& v, const Vec3& axis, double angle) {
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

/// The smallest cone around two, each given by axis and cosine of its half angle.
void merge_cones(const LightCluster& a, const LightCluster& b, LightCluster* out) {
  const double angle_a = std::acos(std::clamp<double>(a.cos_o, -1, 1));
  const double angle_b = std::acos(std::clamp<double>(b.cos_o, -1, 1));
  const double between = std::acos(std::clamp<double>(dot(a.axis, b.axis), -1, 1));
  if (std::min(between + angle_b, M_PI) <= angle_a) {
    out->axis = a.axis;
    out->cos_o = a.cos_o;
    return;
  }
  if (std::min(between + angle_a, M_PI) <= angle_b) {
    out->axis = b.axis;
    out->cos_o = b.cos_o;
    return;
  }
  const double angle = (angle_a + between + angle_b) / 2;
  const Vec3 pivot = cross(a.axis, b.axis);
  if (angle >= M_PI || !(dot(pivot, pivot) > 0)) {
    out->axis = a.axis;
    out->cos_o = -1;  // all directions
    return;
  }
  out->axis = normalize(rotated(a.axis, normalize(pivot), angle - angle_a));
  // A hair wider, so that rounding of the axis leaves nothing out.
  out->cos_o = std::max(-1.0f, static_cast<float>(std::cos(angle)) - 1e-5f);
}

LightCluster merged(const LightCluster& a, const LightCluster& b) {
  if (!(a.power > 0)) return b;
  if (!(b.power > 0)) return a;
  LightCluster out;
  out.bounds = a.bounds;
  out.bounds.extend(b.bounds.low);
  out.bounds.extend(b.bounds.high);
  out.power = a.power + b.power;
  out.cos_e = std::min(a.cos_e, b.cos_e);
  out.two_sided = a.two_sided || b.two_sided;
  merge_cones(a, b, &out);
  return out;
}

/// Cost of a child: power by the area of its bounds and the solid angle that it shines into.
double split_cost(const LightCluster& c, const Vec3& extent, int axis) {
  if (!(c.power > 0)) return 0;
  const double o = std::acos(std::clamp<double>(c.cos_o, -1, 1));
  const double e = std::acos(std::clamp<double>(c.cos_e, -1, 1));
  const double w = std::min(o + e, M_PI), sin_o = std::sin(o);
  const double solid_angle =
      2 * M_PI * (1 - std::cos(o)) +
      M_PI / 2 * (2 * w * sin_o - std::cos(o - 2 * w) - 2 * o * sin_o + std::cos(o));
  const Vec3 d = c.bounds.extent();
  const double area = 2.0 * (d.x * d.y + d.y * d.z + d.z * d.x);
  return c.power * solid_angle * (max_component(extent) / std::max(extent[axis], 1e-30f)) * area;
}

}  // namespace

LightTree::LightTree(const std::vector<LightCluster>& lights)
    : trails_(lights.size()), present_(lights.size()) {
  std::vector<Item> items;
  for (size_t i = 0; i < lights.size(); ++i) {
    if (!(lights[i].power > 0)) continue;
    present_[i] = 1;
    items.push_back({lights[i], lights[i].bounds.center(), static_cast<uint32_t>(i)});
  }
  if (items.empty()) return;
  nodes_.reserve(2 * items.size());
  build(items, 0, items.size(), 0, 0);
}

void LightTree::build(std::vector<Item>& items, size_t begin, size_t end, uint64_t trail,
                      int depth) {
  const size_t at = nodes_.size();
  nodes_.emplace_back();
  if (end - begin == 1) {
    nodes_[at] = {items[begin].cluster, items[begin].light, true};
    trails_[items[begin].light] = trail;
    return;
  }
  Bounds bounds, centers;
  LightCluster all;
  for (size_t i = begin; i < end; ++i) {
    bounds.extend(items[i].cluster.bounds.low);
    bounds.extend(items[i].cluster.bounds.high);
    centers.extend(items[i].center);
    all = merged(all, items[i].cluster);
  }
  double best = INFINITY;
  int best_axis = 0, best_bucket = -1;
  const auto bucket_of = [&centers](const Vec3& p, int axis) {
    const float t = (p[axis] - centers.low[axis]) / (centers.high[axis] - centers.low[axis]);
    return std::clamp(static_cast<int>(t * kBuckets), 0, kBuckets - 1);
  };
  for (int axis = 0; axis < 3 && depth < kMaxCostDepth; ++axis) {
    if (!(centers.extent()[axis] > 0)) continue;
    std::array<LightCluster, kBuckets> buckets, after;
    for (size_t i = begin; i < end; ++i) {
      LightCluster& bucket = buckets[static_cast<size_t>(bucket_of(items[i].center, axis))];
      bucket = merged(bucket, items[i].cluster);
    }
    after[kBuckets - 1] = buckets[kBuckets - 1];
    for (size_t b = kBuckets - 1; b-- > 0;) after[b] = merged(buckets[b], after[b + 1]);
    LightCluster before;
    for (size_t b = 0; b + 1 < kBuckets; ++b) {
      before = merged(before, buckets[b]);
      if (!(before.power > 0) || !(after[b + 1].power > 0)) continue;
      const double cost = split_cost(before, bounds.extent(), axis) +
                          split_cost(after[b + 1], bounds.extent(), axis);
      if (cost < best) {
        best = cost;
        best_axis = axis;
        best_bucket = static_cast<int>(b);
      }
    }
  }
  auto middle = items.begin() + static_cast<std::ptrdiff_t>((begin + end) / 2);
  const auto first = items.begin() + static_cast<std::ptrdiff_t>(begin),
             last = items.begin() + static_cast<std::ptrdiff_t>(end);
  if (best_bucket >= 0) {
    middle = std::stable_partition(first, last, [&](const Item& item) {
      return bucket_of(item.center, best_axis) <= best_bucket;
    });
  }
  const auto split = static_cast<size_t>(middle - items.begin());
  build(items, begin, split, trail, depth + 1);
  const auto second = static_cast<uint32_t>(nodes_.size());
  build(items, split, end, trail | (uint64_t{1} << depth), depth + 1);
  nodes_[at] = {all, second, false};
  children_.resize(nodes_.size());
  children_[at] = children_of(nodes_[at + 1].cluster, nodes_[second].cluster);
}

LightTree::Children LightTree::children_of(const LightCluster& first, const LightCluster& second) {
  Children out;
  for (int k = 0; k < 2; ++k) {
    const LightCluster& cluster = k == 0 ? first : second;
    const Vec3 center = cluster.bounds.center(), half = cluster.bounds.extent() * 0.5f;
    out.x[k] = center.x;
    out.y[k] = center.y;
    out.z[k] = center.z;
    out.radius2[k] = dot(half, half);
    out.axis_x[k] = cluster.axis.x;
    out.axis_y[k] = cluster.axis.y;
    out.axis_z[k] = cluster.axis.z;
    out.power[k] = cluster.power;
    out.cos_o[k] = cluster.cos_o;
    out.sin_o[k] = sine(cluster.cos_o);
    out.cos_e[k] = cluster.cos_e;
    out.two_sided[k] = cluster.two_sided ? -1 : 0;
  }
  return out;
}

/// The importance of both children at once: an upper estimate, up to a factor, of what a cluster
/// brings to a point; zero only if it brings nothing. b is the cone that the sphere around its
/// bounds is seen under, w the angle to its axis. Spots shine less than half around, but all that
/// they do counts: no cosine law for them.
bool LightTree::first_share(uint32_t node, const Vec3& position, const Vec3& normal,
                            double* share) const {
  const Children& at = children_[node];
  const Pair zero = both(0), one = both(1);
  const Pair x = position.x - load(at.x), y = position.y - load(at.y), z = position.z - load(at.z);
  const Pair radius2 = load(at.radius2), distance2 = x * x + y * y + z * z;
  const Pair d2 = largest(distance2, radius2), power = load(at.power);
  const Pair inverse = 1 / root(distance2);
  const auto apart = distance2 > zero;  // else the point is the centre, seen along z
  const Pair from_x = apart ? x * inverse : zero, from_y = apart ? y * inverse : zero,
             from_z = apart ? z * inverse : one;
  const Pair cos_b =
      distance2 <= radius2 * 1.0001f ? -one : root_of_positive(1 - radius2 / distance2);
  const Pair sin_b = sines(cos_b);
  Pair cos_w =
      within_one(load(at.axis_x) * from_x + load(at.axis_y) * from_y + load(at.axis_z) * from_z);
  cos_w = load(at.two_sided) ? largest(cos_w, -cos_w) : cos_w;
  const Pair sin_w = sines(cos_w), cos_o = load(at.cos_o), sin_o = load(at.sin_o);
  const auto inside = cos_w > cos_o;
  const Pair cos_x = inside ? one : cos_w * cos_o + sin_w * sin_o;
  const Pair sin_x = inside ? zero : sin_w * cos_o - cos_w * sin_o;
  const Pair cos_emitted = cos_x > cos_b ? one : cos_x * cos_b + sin_x * sin_b;
  Pair importance = power * largest(cos_emitted, zero) / d2;
  if (dot(normal, normal) > 0) {
    const Pair cos_i = within_one(-(from_x * normal.x + from_y * normal.y + from_z * normal.z));
    const Pair seen = cos_i > cos_b ? one : cos_i * cos_b + sines(cos_i) * sin_b;
    importance *= largest(seen, zero);
  }
  importance = cos_emitted <= load(at.cos_e) ? zero : importance;
  importance = d2 > zero ? importance : power;
  const double a = double{importance[0]}, b = double{importance[1]};
  *share = a / (a + b);
  return a + b > 0;
}

template <typename ShareOf>
bool LightTree::descend(const ShareOf& share_of, double u, uint32_t* light,
                        float* probability) const {
  if (nodes_.empty()) return false;
  double p = 1, share = 0;
  uint32_t node = 0;
  while (!nodes_[node].leaf) {
    if (!share_of(node, &share)) return false;
    if (u < share) {
      u /= share;
      p *= share;
      ++node;
    } else {
      u = (u - share) / (1 - share);
      p *= 1 - share;
      node = nodes_[node].index;
    }
    u = std::min(u, 1 - 0x1p-53);
  }
  *light = nodes_[node].index;
  *probability = static_cast<float>(p);
  return true;
}

bool LightTree::sample(const Vec3& position, const Vec3& normal, double u, uint32_t* light,
                       float* probability) const {
  const auto share_of = [&](uint32_t node, double* share) {
    return first_share(node, position, normal, share);
  };
  return descend(share_of, u, light, probability);
}

bool LightTreeWalk::sample(double u, uint32_t* light, float* probability) {
  const auto share_of = [this](uint32_t node, double* share) {
    Entry& entry = entries_[node % entries_.size()];
    if (entry.point != point_ || entry.node != node) {
      entry = {point_, node, false, 0};
      entry.drawn = tree_->first_share(node, position_, normal_, &entry.share);
    }
    *share = entry.share;
    return entry.drawn;
  };
  return tree_->descend(share_of, u, light, probability);
}

float LightTree::probability(const Vec3& position, const Vec3& normal, uint32_t light) const {
  if (!present_[light]) return 0;
  double p = 1, share = 0;
  uint32_t node = 0;
  for (uint64_t trail = trails_[light]; !nodes_[node].leaf; trail >>= 1) {
    if (!first_share(node, position, normal, &share)) return 0;
    p *= (trail & 1) ? 1 - share : share;
    node = (trail & 1) ? nodes_[node].index : node + 1;
  }
  return static_cast<float>(p);
}

}  // namespace lte::pathtrace
