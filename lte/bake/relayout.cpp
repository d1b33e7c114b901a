#include "lte/bake/relayout.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "lte/base/check.h"
#include "lte/base/checksum.h"
#include "lte/base/text.h"

namespace lte::bake {
namespace {

/// How much a size may differ, relative: charts have the density of the world.
constexpr float kSameSize = 1e-3f;
/// Texels between charts, beside those that bilinear look-ups read.
constexpr int kApart = 2;
constexpr const char* kOtherwise = "; bake without --since";

template <typename T>
void add_all(Checksum* sum, const std::vector<T>& values) {
  const uint64_t count = values.size();
  sum->add(&count, sizeof count);
  if (!values.empty()) sum->add(values.data(), sizeof(T) * values.size());
}

std::string fingerprint_of(const scene::Mesh& mesh) {
  Checksum sum;
  add_all(&sum, mesh.positions);
  add_all(&sum, mesh.triangles);
  for (const std::vector<Vec2>& uvs : mesh.uvs) add_all(&sum, uvs);
  add_all(&sum, mesh.colors);
  add_all(&sum, mesh.normals);
  return formatted("%016llx", static_cast<unsigned long long>(sum.value()));
}

bool same_place(const Affine& a, const Affine& b) {
  return std::memcmp(&a.m, &b.m, sizeof a.m) == 0;
}

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
  std::vector<int> out(now.size(), scene::kNone);
  std::vector<uint8_t> taken(old.objects.size());
  for (const bool in_place : {true, false}) {
    for (size_t i = 0; i < now.size(); ++i) {
      for (size_t j = 0; j < old.objects.size() && out[i] == scene::kNone; ++j) {
        const Affine& there = old.scene.instances[j].to_world;
        const Affine& here = scene.instances[i].to_world;
        if (taken[j] != 0 || now[i] != old.objects[j]) continue;
        if (!(in_place ? same_place(here, there) : same_size(here, there))) continue;
        taken[j] = 1;
        out[i] = static_cast<int>(j);
      }
    }
  }
  return out;
}

/// Pixels that are free for new charts.
class Room {
 public:
  Room(int width, int height) : width_(width), height_(height), taken_(at(0, height, width)) {}

  /// With the space between charts.
  void take(int x, int y, int w, int h) {
    for (int py = std::max(0, y - kApart); py < std::min(height_, y + h + kApart); ++py)
      for (int px = std::max(0, x - kApart); px < std::min(width_, x + w + kApart); ++px)
        taken_[at(px, py, width_)] = 1;
  }
  /// The first place of a rectangle, row by row.
  std::optional<std::pair<int, int>> find(int w, int h) const {
    // Sums over the rectangle from the corner to each pixel.
    const int stride = width_ + 1;
    std::vector<int64_t> sum(at(0, height_ + 1, stride));
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x)
        sum[at(x + 1, y + 1, stride)] = taken_[at(x, y, width_)] + sum[at(x + 1, y, stride)] +
                                        sum[at(x, y + 1, stride)] - sum[at(x, y, stride)];
    for (int y = 0; y + h <= height_; ++y) {
      for (int x = 0; x + w <= width_; ++x) {
        if (sum[at(x + w, y + h, stride)] - sum[at(x + w, y, stride)] - sum[at(x, y + h, stride)] +
                sum[at(x, y, stride)] ==
            0)
          return std::pair{x, y};
      }
    }
    return std::nullopt;
  }

 private:
  static size_t at(int x, int y, int stride) {
    return static_cast<size_t>(y) * static_cast<size_t>(stride) + static_cast<size_t>(x);
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

scene::Scene with_instance(const scene::Scene& scene, size_t instance) {
  scene::Scene out = scene;
  out.instances = {scene.instances[instance]};
  return out;
}

/// Charts of one new instance, each in the place that it gets in the picture; uvs[1] in pixels.
scene::Mesh new_mesh(const scene::Scene& scene, size_t instance, const OldAtlas& old, Room* room) {
  const scene::Scene alone = with_instance(scene, instance);
  AtlasOptions options;
  options.texels_per_metre = old.texels_per_metre;
  const Atlas one = make_atlas_of_charts(alone, options);
  scene::Mesh out = one.scene.meshes[0];
  out.name = scene.meshes[static_cast<size_t>(alone.instances[0].mesh)].name;
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
    uv = {uv.x * static_cast<float>(one.width) + by.x,
          uv.y * static_cast<float>(one.height) + by.y};
  }
  return out;
}

bool has_area(const scene::Scene& scene, size_t instance) {
  const Affine& to_world = scene.instances[instance].to_world;
  const scene::Mesh& mesh = scene.meshes[static_cast<size_t>(scene.instances[instance].mesh)];
  for (const auto& t : mesh.triangles) {
    const Vec3 a = to_world.point(mesh.positions[t[0]]);
    if (length(cross(to_world.point(mesh.positions[t[1]]) - a,
                     to_world.point(mesh.positions[t[2]]) - a)) > 0)
      return true;
  }
  return false;
}

/// Meshes of what is still there, with the old charts, which uvs[1] has in pixels.
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
    if (!has_area(scene, i)) {
      mesh.uvs[1].assign(mesh.positions.size(), {0, 0});
      continue;
    }
    mesh = new_mesh(scene, i, old, &room);
    for (Vec2& uv : mesh.uvs[1])
      uv = {std::clamp(uv.x / static_cast<float>(old.width), 0.0f, 1.0f),
            std::clamp(uv.y / static_cast<float>(old.height), 0.0f, 1.0f)};
  }
  name_apart(of, &out.scene);
  return out;
}

}  // namespace

std::vector<std::string> mesh_fingerprints(const scene::Scene& scene) {
  std::vector<std::string> of_mesh, out;
  for (const scene::Mesh& mesh : scene.meshes) of_mesh.push_back(fingerprint_of(mesh));
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
