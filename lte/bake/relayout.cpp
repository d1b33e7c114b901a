#include "lte/bake/relayout.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/fingerprint.h"
#include "lte/scene/sampler.h"

namespace lte::bake {
namespace {

/// How much a size may differ, relative: charts have the density of the world.
constexpr float kSameSize = 1e-3f;
/// Texels between charts, beside those that bilinear look-ups read.
constexpr int kApart = 2;
constexpr const char* kOtherwise = "; bake without --since";

bool same_place(const Affine& a, const Affine& b) { return a.m == b.m; }

bool same_size(const Affine& a, const Affine& b) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto length_of = [&](const Affine& m) {
      return length(Vec3{m.m[0][axis], m.m[1][axis], m.m[2][axis]});
    };
    if (std::abs(length_of(a) - length_of(b)) > kSameSize * length_of(b)) return false;
  }
  return true;
}

/// Each instance's old one: that in the same place, else the first of its mesh and size.
std::vector<int> find_old(const scene::Scene& scene, const OldAtlas& old) {
  const std::vector<std::string> now = mesh_fingerprints(scene);
  std::map<std::string, std::vector<size_t>> free;  // old instances of a mesh
  for (size_t j = 0; j < old.objects.size(); ++j) free[old.objects[j]].push_back(j);
  std::vector<int> out(now.size(), scene::kNone);
  for (const auto& same : {same_place, same_size}) {
    for (size_t i = 0; i < now.size(); ++i) {
      if (out[i] != scene::kNone) continue;
      std::vector<size_t>& there = free[now[i]];
      const auto at = std::find_if(there.begin(), there.end(), [&](size_t j) {
        return same(scene.instances[i].to_world, old.scene.instances[j].to_world);
      });
      if (at == there.end()) continue;
      out[i] = static_cast<int>(*at);
      there.erase(at);
    }
  }
  return out;
}

/// Pixels that are free for new charts.
class Room {
 public:
  Room(int width, int height) : width_(width), height_(height), taken_(at(0, height)) {}

  /// With the space between charts.
  void take(int x, int y, int w, int h) {
    const int end = std::min(width_, x + w + kApart);
    for (int py = std::max(0, y - kApart); py < std::min(height_, y + h + kApart); ++py)
      for (int px = std::max(0, x - kApart); px < end; ++px) taken_[at(px, py)] = 1;
  }

  /// The first place of a rectangle, row by row. What is taken is jumped over.
  std::optional<std::pair<int, int>> find(int w, int h) const {
    for (int y = 0; y + h <= height_; ++y) {
      int x = 0;
      while (x + w <= width_) {
        const int obstacle = last_taken(x, y, w, h);
        if (obstacle < x) return std::pair{x, y};
        x = obstacle + 1;
      }
    }
    return std::nullopt;
  }

 private:
  size_t at(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  /// The right-most taken column of the first row of a rectangle that has one; else -1.
  int last_taken(int x, int y, int w, int h) const {
    for (int py = y; py < y + h; ++py)
      for (int px = x + w - 1; px >= x; --px)
        if (taken_[at(px, py)] != 0) return px;
    return -1;
  }

  int width_, height_;
  std::vector<uint8_t> taken_;
};

/// The pixels that a chart touches.
struct ChartBox {
  float x0 = 1e9f, y0 = 1e9f, x1 = 0, y1 = 0;

  void add(float x, float y) {
    x0 = std::min(x0, x);
    x1 = std::max(x1, x);
    y0 = std::min(y0, y);
    y1 = std::max(y1, y);
  }
  int left() const { return static_cast<int>(x0); }
  int top() const { return static_cast<int>(y0); }
  int width() const { return static_cast<int>(x1) - left() + 1; }
  int height() const { return static_cast<int>(y1) - top() + 1; }
};

/// An instance alone, without material.
scene::Scene only(const scene::Scene& scene, size_t instance) {
  scene::Scene out;
  out.name = scene.name;
  out.instances = {scene.instances[instance]};
  out.meshes = {scene.meshes[static_cast<size_t>(out.instances[0].mesh)]};
  out.instances[0].mesh = 0;
  return out;
}

/// The mesh of a new instance, each chart in the place that it gets in the picture.
scene::Mesh new_mesh(const scene::Scene& alone, const OldAtlas& old, Room* room) {
  AtlasOptions options;
  options.texels_per_metre = old.texels_per_metre;
  const Atlas one = make_atlas_of_charts(alone, options);
  scene::Mesh out = one.scene.meshes[0];
  out.name = alone.meshes[0].name;
  std::vector<ChartBox> boxes(static_cast<size_t>(one.charts));
  std::vector<int32_t> chart_of(out.positions.size(), scene::kNone);
  for (size_t t = 0; t < out.triangles.size(); ++t) {
    const int32_t chart = one.chart[0][t];
    for (const uint32_t v : out.triangles[t]) {
      if (chart == scene::kNone) continue;
      chart_of[v] = chart;
      boxes[static_cast<size_t>(chart)].add(out.uvs[1][v].x * static_cast<float>(one.width),
                                            out.uvs[1][v].y * static_cast<float>(one.height));
    }
  }
  std::vector<size_t> order(boxes.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return boxes[a].height() > boxes[b].height(); });
  std::vector<Vec2> shift(boxes.size());
  for (const size_t k : order) {
    const ChartBox& box = boxes[k];
    const auto place = room->find(box.width(), box.height());
    LTE_CHECK(place, old.name, ": its atlas has no room of ", box.width(), " x ", box.height(),
              " texels for a chart of \"", out.name, "\"", kOtherwise, ", which moves all charts");
    room->take(place->first, place->second, box.width(), box.height());
    shift[k] = {static_cast<float>(place->first - box.left()),
                static_cast<float>(place->second - box.top())};
  }
  for (size_t v = 0; v < chart_of.size(); ++v) {
    Vec2& uv = out.uvs[1][v];
    const Vec2 by = chart_of[v] == scene::kNone ? Vec2{} : shift[static_cast<size_t>(chart_of[v])];
    const float x = uv.x * static_cast<float>(one.width) + by.x;
    const float y = uv.y * static_cast<float>(one.height) + by.y;
    uv = {std::clamp(x / static_cast<float>(old.width), 0.0f, 1.0f),
          std::clamp(y / static_cast<float>(old.height), 0.0f, 1.0f)};
  }
  return out;
}

/// Meshes of what is still there, with the old charts.
Atlas old_charts(const scene::Scene& scene, const OldAtlas& old, const std::vector<int>& of) {
  Atlas out;
  out.width = old.width;
  out.height = old.height;
  out.texels_per_metre = old.texels_per_metre;
  out.scene = scene;
  out.scene.meshes.clear();
  for (size_t i = 0; i < of.size(); ++i) {
    scene::Mesh mesh = scene.meshes[static_cast<size_t>(scene.instances[i].mesh)];
    const int material = mesh.material;
    if (of[i] != scene::kNone) {
      mesh = old.scene.meshes[static_cast<size_t>(of[i])];
      mesh.material = material;
    }
    out.scene.meshes.push_back(std::move(mesh));
    out.scene.instances[i].mesh = static_cast<int>(i);
  }
  return out;
}

void name_apart(const std::vector<int>& of, scene::Scene* scene) {
  std::set<std::string> names;
  for (size_t i = 0; i < of.size(); ++i)
    if (of[i] != scene::kNone) names.insert(scene->meshes[i].name);
  for (size_t i = 0; i < of.size(); ++i) {
    if (of[i] != scene::kNone) continue;
    const std::string base = scene->meshes[i].name.empty() ? "mesh" : scene->meshes[i].name;
    std::string name = base;
    for (int k = 2; !names.insert(name).second; ++k) name = concat(base, "_", k);
    scene->meshes[i].name = name;
  }
}

Atlas keep_charts(const scene::Scene& scene, const OldAtlas& old, const std::vector<int>& of) {
  Atlas out = old_charts(scene, old, of);
  Room room(old.width, old.height);
  // Corners of a texel that a triangle touches: its box, a pixel wider.
  for (size_t i = 0; i < of.size(); ++i) {
    if (of[i] == scene::kNone) continue;
    const scene::Mesh& mesh = out.scene.meshes[i];
    for (const auto& t : mesh.triangles) {
      Vec2 low{1, 1}, high{0, 0};
      for (const uint32_t v : t) {
        const Vec2 uv = mesh.uvs[1][v];
        low = {std::min(low.x, uv.x), std::min(low.y, uv.y)};
        high = {std::max(high.x, uv.x), std::max(high.y, uv.y)};
      }
      const int x = static_cast<int>(low.x * static_cast<float>(old.width));
      const int y = static_cast<int>(low.y * static_cast<float>(old.height));
      room.take(x, y, static_cast<int>(high.x * static_cast<float>(old.width)) - x + 1,
                static_cast<int>(high.y * static_cast<float>(old.height)) - y + 1);
    }
  }
  for (size_t i = 0; i < of.size(); ++i) {
    if (of[i] != scene::kNone) continue;
    scene::Mesh& mesh = out.scene.meshes[i];
    const scene::Scene alone = only(scene, i);
    if (scene::surface_area(alone) > 0) {
      mesh = new_mesh(alone, old, &room);
    } else {
      mesh.uvs[1].assign(mesh.positions.size(), {0, 0});
    }
  }
  name_apart(of, &out.scene);
  return out;
}

}  // namespace

std::vector<std::string> mesh_fingerprints(const scene::Scene& scene) {
  std::vector<std::string> of_mesh, out;
  for (const scene::Mesh& mesh : scene.meshes) of_mesh.push_back(scene::mesh_fingerprint(mesh));
  for (const scene::Instance& instance : scene.instances)
    out.push_back(of_mesh[static_cast<size_t>(instance.mesh)]);
  return out;
}

Relayout lay_out_again(const scene::Scene& scene, const OldAtlas& old) {
  Relayout out;
  out.old_instance = find_old(scene, old);
  const bool any = std::any_of(out.old_instance.begin(), out.old_instance.end(),
                               [](int j) { return j != scene::kNone; });
  LTE_CHECK(any, old.name, ": nothing of what it shows is in this scene", kOtherwise);
  for (size_t i = 0; i < out.old_instance.size(); ++i) {
    const int j = out.old_instance[i];
    const bool moved =
        j == scene::kNone || !same_place(scene.instances[i].to_world,
                                         old.scene.instances[static_cast<size_t>(j)].to_world);
    out.moved.push_back(moved ? 1 : 0);
  }
  if (old.kept_uvs) {
    AtlasOptions options;
    options.size = old.width;
    options.keep_uvs = true;
    out.layout = make_layout(scene, options);
  } else {
    out.layout.atlas = keep_charts(scene, old, out.old_instance);
    finish_atlas(scene, &out.layout.atlas);
    out.layout.texels = find_texels(out.layout.atlas);
  }
  return out;
}

}  // namespace lte::bake
