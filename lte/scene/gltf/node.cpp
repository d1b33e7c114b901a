// The node hierarchy: transforms and instances.
#include <array>
#include <cmath>

#include "lte/base/check.h"
#include "lte/scene/gltf/context.h"

namespace lte::scene::gltf {
namespace {

/// A 3x4 transform in double: far-off parents and children that bring them back must not cost
/// digits.
struct Transform {
  std::array<std::array<double, 4>, 3> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
};

Transform operator*(const Transform& a, const Transform& b) {
  Transform out;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t col = 0; col < 4; ++col) {
      out.m[row][col] = col == 3 ? a.m[row][3] : 0.0;
      for (size_t k = 0; k < 3; ++k) out.m[row][col] += a.m[row][k] * b.m[k][col];
    }
  }
  return out;
}

Transform from_matrix(const std::vector<double>& columns) {
  Transform out;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t col = 0; col < 4; ++col) out.m[row][col] = columns[col * 4 + row];
  }
  return out;
}

/// Translation * rotation * scale; `q` is a unit quaternion x, y, z, w.
Transform from_trs(const std::array<double, 3>& t, const std::array<double, 4>& q,
                   const std::array<double, 3>& s) {
  const auto [x, y, z, w] = q;
  const std::array<std::array<double, 3>, 3> r{
      {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
       {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
       {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
  Transform out;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t col = 0; col < 3; ++col) out.m[row][col] = r[row][col] * s[col];
    out.m[row][3] = t[row];
  }
  return out;
}

std::array<double, 4> unit(std::array<double, 4> q, const std::string& where) {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  LTE_CHECK(norm > 0, where, " is the zero quaternion");
  for (double& value : q) value /= norm;
  return q;
}

Transform local_transform(const tinygltf::Node& node, const std::string& where) {
  if (!node.matrix.empty()) {
    const std::vector<double>& m = node.matrix;
    LTE_CHECK(m[3] == 0 && m[7] == 0 && m[11] == 0 && m[15] == 1, where, ".matrix is not affine");
    return from_matrix(m);
  }
  std::array<double, 3> t{0, 0, 0}, s{1, 1, 1};
  std::array<double, 4> q{0, 0, 0, 1};
  if (!node.translation.empty()) std::copy_n(node.translation.begin(), 3, t.begin());
  if (!node.scale.empty()) std::copy_n(node.scale.begin(), 3, s.begin());
  if (!node.rotation.empty()) {
    std::copy_n(node.rotation.begin(), 4, q.begin());
    q = unit(q, where + ".rotation");
  }
  return from_trs(t, q, s);
}

Affine to_affine(const Transform& transform) {
  Affine out;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t col = 0; col < 4; ++col)
      out.m[row][col] = static_cast<float>(transform.m[row][col]);
  }
  return out;
}

class Walk {
 public:
  explicit Walk(const Context& context)
      : context_(context), state_(context.model.nodes.size(), State::New) {}

  std::vector<Placement> run(const std::vector<int>& roots) {
    for (const int root : roots) visit(root, Transform{}, 1);
    return std::move(out_);
  }

 private:
  enum class State : uint8_t { New, Open, Done };

  void visit(int index, const Transform& parent, int depth) {
    const std::string where = concat(context_.file.name, ": nodes[", index, "]");
    State& state = state_[static_cast<size_t>(index)];
    LTE_CHECK(state != State::Open, where, " is its own ancestor");
    LTE_CHECK(state != State::Done, where, " has more than one parent");
    LTE_CHECK(depth <= context_.limits.node_depth, where, " lies deeper than ",
              context_.limits.node_depth, " levels");
    state = State::Open;
    const tinygltf::Node& node = context_.model.nodes[static_cast<size_t>(index)];
    const Transform world = parent * local_transform(node, where);
    const Placement placement{index, to_affine(world), kNone, false};
    for (const auto& row : placement.to_world.m) {
      for (const float value : row)
        LTE_CHECK(std::isfinite(value), where, ": its transform to the world is not finite");
    }
    out_.push_back(placement);
    for (const int child : node.children) visit(child, world, depth + 1);
    state_[static_cast<size_t>(index)] = State::Done;
  }

  const Context& context_;
  std::vector<State> state_;
  std::vector<Placement> out_;
};

/// EXT_mesh_gpu_instancing of a node: TRANSLATION, ROTATION and SCALE, one an instance.
class InstanceList {
 public:
  InstanceList(const Context& context, int node, const tinygltf::Value& attributes)
      : where_(concat("nodes[", node, "].EXT_mesh_gpu_instancing")), file_(context.file.name) {
    constexpr std::array<std::pair<const char*, int>, 3> kParts{
        {{"TRANSLATION", 3}, {"ROTATION", 4}, {"SCALE", 3}}};
    for (size_t k = 0; k < kParts.size(); ++k) {
      const auto& [name, components] = kParts[k];
      if (!attributes.Has(name)) continue;
      parts_[k] = std::make_unique<Accessor>(context, attributes.Get(name).GetNumberAsInt(),
                                             concat(where_, ".", name));
      LTE_CHECK(parts_[k]->components() == components, parts_[k]->what(), " has ",
                parts_[k]->components(), " components, expected ", components);
      LTE_CHECK(count_ == kUnknown || count_ == parts_[k]->count(), parts_[k]->what(), " has ",
                parts_[k]->count(), " elements, but another attribute ", count_);
      count_ = parts_[k]->count();
    }
    LTE_CHECK(count_ != kUnknown, file_, ": ", where_, " has none of TRANSLATION, ROTATION, SCALE");
    if (static_cast<int64_t>(count_) > context.limits.triangles)
      throw OverLimit(concat(file_, ": ", where_, " has ", count_, " instances, more than ",
                             context.limits.triangles),
                      "triangles", static_cast<int64_t>(count_));
  }

  std::vector<Affine> transforms(const Affine& to_world) const {
    std::vector<Affine> out;
    out.reserve(count_);
    for (size_t i = 0; i < count_; ++i) {
      std::array<double, 3> t{0, 0, 0}, s{1, 1, 1};
      std::array<double, 4> q{0, 0, 0, 1};
      read(0, i, &t);
      read(1, i, &q);
      read(2, i, &s);
      const Affine placed =
          to_world *
          to_affine(from_trs(t, unit(q, concat(file_, ": ", where_, ".ROTATION[", i, "]")), s));
      for (const auto& row : placed.m) {
        for (const float value : row)
          LTE_CHECK(std::isfinite(value), file_, ": ", where_, ": instance ", i, " is not finite");
      }
      out.push_back(placed);
    }
    return out;
  }

 private:
  static constexpr size_t kUnknown = ~size_t{0};

  template <size_t N>
  void read(size_t part, size_t i, std::array<double, N>* values) const {
    if (!parts_[part]) return;
    for (size_t c = 0; c < N; ++c) (*values)[c] = parts_[part]->value(i, static_cast<int>(c));
  }

  std::string where_, file_;
  std::array<std::unique_ptr<Accessor>, 3> parts_;
  size_t count_ = kUnknown;
};

std::vector<int> root_nodes(const Context& context) {
  const tinygltf::Model& model = context.model;
  if (model.defaultScene >= 0) return model.scenes[static_cast<size_t>(model.defaultScene)].nodes;
  if (!model.scenes.empty()) return model.scenes.front().nodes;
  std::vector<bool> is_child(model.nodes.size());
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) is_child[static_cast<size_t>(child)] = true;
  }
  std::vector<int> roots;
  for (size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots.push_back(static_cast<int>(i));
  }
  LTE_CHECK(model.nodes.empty() || !roots.empty(), context.file.name,
            ": every node has a parent, so nodes are cyclic");
  return roots;
}

}  // namespace

std::vector<Placement> place_nodes(const Context& context) {
  return Walk(context).run(root_nodes(context));
}

std::vector<Affine> instance_transforms(const Context& context, const Placement& placement) {
  const tinygltf::Node& node = context.model.nodes[static_cast<size_t>(placement.node)];
  const auto instancing = node.extensions.find("EXT_mesh_gpu_instancing");
  if (placement.skinned) return {Affine{}};
  if (instancing == node.extensions.end() || !instancing->second.Has("attributes"))
    return {placement.to_world};
  return InstanceList(context, placement.node, instancing->second.Get("attributes"))
      .transforms(placement.to_world);
}

}  // namespace lte::scene::gltf
