#include "lte/bake/refined_scene.h"

#include <cstring>
#include <tuple>
#include <utility>

#include "lte/base/random.h"
#include "lte/scene/triangle.h"

namespace lte::bake {
namespace {

uint64_t pair_key(uint32_t a, uint32_t b) {
  return a < b ? (uint64_t{a} << 32) | b : (uint64_t{b} << 32) | a;
}

struct PlaceHash {
  size_t operator()(const Vec3& p) const {
    uint64_t out = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float value = p[axis] + 0.0f;  // −0 is 0
      uint32_t bits = 0;
      std::memcpy(&bits, &value, sizeof bits);
      out = hash_combine(out, bits);
    }
    return out;
  }
};

template <typename Value, typename Mean>
void add_mean(std::vector<Value>* values, uint32_t a, uint32_t b, const Mean& mean) {
  if (!values->empty()) values->push_back(mean((*values)[a], (*values)[b]));
}

/// Adds the middle of two vertices. @return its number
uint32_t add_middle(scene::Mesh* mesh, uint32_t a, uint32_t b) {
  const auto half = [](const Vec3& x, const Vec3& y) { return (x + y) * 0.5f; };
  mesh->positions.push_back(half(mesh->positions[a], mesh->positions[b]));
  add_mean(&mesh->colors, a, b, half);
  add_mean(&mesh->normals, a, b, [](const Vec3& x, const Vec3& y) { return normalize(x + y); });
  add_mean(&mesh->tangents, a, b, [](const scene::Tangent& x, const scene::Tangent& y) {
    return scene::Tangent{x.direction + y.direction, x.sign};
  });
  for (std::vector<Vec2>& uvs : mesh->uvs) {
    add_mean(&uvs, a, b, [](const Vec2& x, const Vec2& y) {
      return Vec2{0.5f * (x.x + y.x), 0.5f * (x.y + y.y)};
    });
  }
  return static_cast<uint32_t>(mesh->positions.size() - 1);
}

}  // namespace

RefinedScene::RefinedScene(scene::Scene scene)
    : scene_(std::move(scene)), made_(scene_.instances.size()) {
  std::unordered_map<Vec3, uint32_t, PlaceHash> number;
  for (uint32_t i = 0; i < scene_.instances.size(); ++i) {
    const scene::Mesh& mesh = scene_.meshes[i];
    const Affine& to_world = scene_.instances[i].to_world;
    std::vector<uint32_t> point;
    for (const Vec3& position : mesh.positions) {
      const Vec3 at = to_world.point(position);
      const auto [found, is_new] = number.try_emplace(at, static_cast<uint32_t>(points_.size()));
      if (is_new) points_.push_back(at);
      point.push_back(found->second);
    }
    const double sign = to_world.determinant() < 0 ? -1 : 1;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& corner = mesh.triangles[t];
      const scene::AreaVector across = scene::area_vector(scene::world_triangle(mesh, to_world, t));
      const double norm = across.norm();
      const double by = norm > 0 ? sign / norm : 0;
      leaves_.push_back({i,
                         corner,
                         {point[corner[0]], point[corner[1]], point[corner[2]]},
                         {static_cast<float>(across.x * by), static_cast<float>(across.y * by),
                          static_cast<float>(across.z * by)}});
    }
  }
}

uint64_t RefinedScene::edge(const Leaf& leaf, size_t k) const {
  return pair_key(leaf.point[k], leaf.point[(k + 1) % 3]);
}

/// The same edge for every triangle that has it as one of its longest.
size_t RefinedScene::longest_edge(const Leaf& leaf) const {
  const auto rank = [&](size_t k) {
    const uint64_t key = edge(leaf, k);
    const Vec3 way = points_[key >> 32] - points_[key & 0xffffffffu];
    return std::tuple{dot(way, way), key};
  };
  size_t out = 0;
  for (const size_t k : {size_t{1}, size_t{2}})
    if (rank(k) > rank(out)) out = k;
  return out;
}

uint32_t RefinedScene::middle_vertex(uint32_t instance, uint32_t a, uint32_t b) {
  const auto [found, is_new] = made_[instance].try_emplace(pair_key(a, b), 0);
  if (is_new) found->second = add_middle(&scene_.meshes[instance], a, b);
  return found->second;
}

void RefinedScene::halve(uint32_t leaf, std::vector<Halving>* done) {
  Leaf first = leaves_[leaf], second = first;
  const size_t k = longest_edge(first), next = (k + 1) % 3;
  const uint32_t vertex = middle_vertex(first.instance, first.vertex[k], first.vertex[next]);
  const uint64_t halved = edge(first, k);
  const auto [found, is_new] = middle_.try_emplace(halved, static_cast<uint32_t>(points_.size()));
  if (is_new) {
    points_.push_back(scene_.instances[first.instance].to_world.point(
        scene_.meshes[first.instance].positions[vertex]));
  }
  done->push_back({leaf, first, halved, is_new});
  first.vertex[next] = second.vertex[k] = vertex;
  first.point[next] = second.point[k] = found->second;
  leaves_[leaf] = first;
  leaves_.push_back(second);
}

/// All but the vertices of meshes, which the next halving of the same edges finds again.
void RefinedScene::take_back(std::vector<Halving> done) {
  for (; !done.empty(); done.pop_back()) {
    const Halving& last = done.back();
    leaves_[last.number] = last.leaf;
    leaves_.pop_back();
    if (!last.is_new) continue;
    middle_.erase(last.edge);
    points_.pop_back();
  }
}

bool RefinedScene::halve(std::span<const uint32_t> which, size_t most) {
  std::vector<Halving> done;
  for (const uint32_t leaf : which) halve(leaf, &done);
  const auto hangs = [&](const Leaf& leaf) {
    return middle_.contains(edge(leaf, 0)) || middle_.contains(edge(leaf, 1)) ||
           middle_.contains(edge(leaf, 2));
  };
  for (size_t before = 0; before != leaves_.size() && leaves_.size() <= most;) {
    before = leaves_.size();
    for (uint32_t i = 0; i < leaves_.size() && leaves_.size() <= most; ++i)
      while (hangs(leaves_[i])) halve(i, &done);
  }
  if (leaves_.size() <= most) return true;
  take_back(std::move(done));
  return false;
}

}  // namespace lte::bake
