// Morph targets and skins in their rest pose.
//
// The rest pose follows the specification (glTF 2.0, 3.7.2.2, 3.7.3 and 3.7.4). A node's weights
// stand in for its mesh's; those that neither gives are zero. A skinned mesh stands where its
// joints put it, whatever its own node's transform. Animations are left out, so nodes are where the
// file says and not where a first frame would put them.
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "lte/base/check.h"
#include "lte/scene/gltf/context.h"

namespace lte::scene::gltf {
namespace {

std::vector<double> rest_weights(const tinygltf::Node& node, const tinygltf::Mesh& mesh) {
  std::vector<double> weights = node.weights.empty() ? mesh.weights : node.weights;
  const bool effect = std::any_of(weights.begin(), weights.end(), [](double w) { return w != 0; });
  return effect ? weights : std::vector<double>{};
}

bool has_joints(const tinygltf::Mesh& mesh) {
  return std::all_of(mesh.primitives.begin(), mesh.primitives.end(),
                     [](const tinygltf::Primitive& primitive) {
                       return primitive.attributes.count("JOINTS_0") > 0 &&
                              primitive.attributes.count("WEIGHTS_0") > 0;
                     });
}

/// A 3x4 matrix that sums in double.
using Blend = std::array<double, 12>;

void add_scaled(const Affine& matrix, double weight, Blend* sum) {
  for (size_t i = 0; i < 12; ++i) (*sum)[i] += weight * matrix.m[i / 4][i % 4];
}

Vec3 transform(const Blend& m, const Vec3& p) {
  const auto row = [&](size_t r) {
    return static_cast<float>(m[4 * r] * p.x + m[4 * r + 1] * p.y + m[4 * r + 2] * p.z +
                              m[4 * r + 3]);
  };
  return {row(0), row(1), row(2)};
}

double determinant(const Blend& m) {
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
         m[2] * (m[4] * m[9] - m[5] * m[8]);
}

/// JOINTS_n and WEIGHTS_n of a primitive: four influences a set.
struct Influences {
  const Buffers& buffers;
  std::vector<std::unique_ptr<Accessor>> joints, weights;
};

Influences read_influences(const Deformation& d) {
  Influences out{d.context.buffers, {}, {}};
  for (int set = 0; d.source.has(concat("JOINTS_", set)); ++set) {
    out.joints.push_back(d.source.attribute(concat("JOINTS_", set)));
    const std::string name = concat("WEIGHTS_", set);
    LTE_CHECK(d.source.has(name), out.joints.back()->what(), " has no ", name, " beside it");
    out.weights.push_back(d.source.attribute(name));
    const Accessor& joints = *out.joints.back();
    LTE_CHECK(joints.component_type() == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                  joints.component_type() == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
              joints.what(), " must hold unsigned bytes or shorts");
    const Accessor& weights = *out.weights.back();
    for (const Accessor* accessor : {&joints, &weights}) {
      LTE_CHECK(accessor->components() == 4 && accessor->count() == d.vertices, accessor->what(),
                " has ", accessor->count(), " elements of ", accessor->components(),
                " components, expected ", d.vertices, " of 4");
    }
  }
  return out;
}

uint32_t read_joint(const Accessor& joints, size_t vertex, int c) {
  const std::byte* at = joints.element(vertex);
  if (joints.component_type() == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE)
    return std::to_integer<uint32_t>(at[c]);
  return std::to_integer<uint32_t>(at[2 * c]) | std::to_integer<uint32_t>(at[2 * c + 1]) << 8;
}

/// The matrix of one vertex. Weights are brought to a sum of one, which quantized ones only come
/// near; a vertex without any hangs on the first joint.
Blend blend(const Influences& influences, size_t vertex, const std::vector<Affine>& matrices) {
  Blend sum{};
  double total = 0;
  for (size_t set = 0; set < influences.joints.size(); ++set) {
    const Accessor &joints = *influences.joints[set], &weights = *influences.weights[set];
    for (int c = 0; c < 4; ++c) {
      const double weight = weights.value(vertex, c);
      LTE_CHECK(std::isfinite(weight) && weight >= 0, weights.what(), ": vertex ", vertex,
                " has the weight ", influences.buffers.shown(weight));
      if (weight == 0) continue;
      const uint32_t joint = read_joint(joints, vertex, c);
      LTE_CHECK(joint < matrices.size(), joints.what(), ": vertex ", vertex, " hangs on joint ",
                influences.buffers.shown(joint), ", but the skin has ", matrices.size());
      add_scaled(matrices[joint], weight, &sum);
      total += weight;
    }
  }
  if (total > 0) {
    for (double& value : sum) value /= total;
  } else {
    add_scaled(matrices.front(), 1, &sum);
  }
  return sum;
}

template <typename T>
void add_displacements(const Accessor& deltas, double weight, int components, const Deformation& d,
                       std::vector<T>* values) {
  if (values->empty()) return;
  const std::vector<T> read = gather_vertices<T>(deltas, components, d.vertices, d.kept);
  for (size_t i = 0; i < read.size(); ++i) {
    for (int c = 0; c < components; ++c) {
      float& value = (&(*values)[i].x)[c];
      value = static_cast<float>(value + weight * (&read[i].x)[c]);
      LTE_CHECK(std::isfinite(value), deltas.what(), ": vertex ", d.kept.empty() ? i : d.kept[i],
                " is not finite once displaced");
    }
  }
}

}  // namespace

std::vector<Shape> find_shapes(const Context& context, std::vector<Placement>* placements) {
  std::map<Shape, int> numbers;
  for (Placement& placement : *placements) {
    const tinygltf::Node& node = context.model.nodes[static_cast<size_t>(placement.node)];
    if (node.mesh < 0) continue;
    const tinygltf::Mesh& mesh = context.model.meshes[static_cast<size_t>(node.mesh)];
    Shape shape{node.mesh, rest_weights(node, mesh), node.skin < 0 ? kNone : node.skin};
    if (shape.skin != kNone && !has_joints(mesh)) {
      context.ignored.add("skin of a mesh without JOINTS_0 and WEIGHTS_0", "node");
      shape.skin = kNone;
    }
    numbers.emplace(std::move(shape), 0);
  }
  std::vector<Shape> shapes;
  for (auto& [shape, number] : numbers) {
    number = static_cast<int>(shapes.size());
    shapes.push_back(shape);
  }
  for (Placement& placement : *placements) {
    const tinygltf::Node& node = context.model.nodes[static_cast<size_t>(placement.node)];
    if (node.mesh < 0) continue;
    const tinygltf::Mesh& mesh = context.model.meshes[static_cast<size_t>(node.mesh)];
    const int skin = node.skin >= 0 && has_joints(mesh) ? node.skin : kNone;
    placement.shape = numbers.at({node.mesh, rest_weights(node, mesh), skin});
    placement.skinned = skin != kNone;
  }
  return shapes;
}

std::vector<Affine> joint_matrices(const Context& context, int index,
                                   const std::vector<Placement>& placements) {
  const tinygltf::Skin& skin = context.model.skins[static_cast<size_t>(index)];
  const std::string where = concat("skins[", index, "]");
  std::map<int, const Affine*> world;
  for (const Placement& placement : placements) world[placement.node] = &placement.to_world;
  std::unique_ptr<Accessor> inverse;
  if (skin.inverseBindMatrices >= 0) {
    inverse = std::make_unique<Accessor>(context, skin.inverseBindMatrices,
                                         where + ".inverseBindMatrices", AccessorUse{true});
    LTE_CHECK(inverse->count() >= skin.joints.size(), inverse->what(), " has ", inverse->count(),
              " matrices for ", skin.joints.size(), " joints");
  }
  std::vector<Affine> out;
  for (size_t j = 0; j < skin.joints.size(); ++j) {
    const auto found = world.find(skin.joints[j]);
    LTE_CHECK(found != world.end(), context.file.name, ": ", where, ".joints[", j, "] is nodes[",
              skin.joints[j], "], which is not in the scene");
    Affine bind;
    for (int k = 0; inverse && k < 16; ++k) {  // column by column
      const float value = inverse->value(j, k);
      const auto row = static_cast<size_t>(k % 4), col = static_cast<size_t>(k / 4);
      LTE_CHECK(std::isfinite(value), inverse->what(), ": matrix ", j, " is not finite");
      if (row < 3) bind.m[row][col] = value;
    }
    out.push_back(*found->second * bind);
  }
  return out;
}

void apply_morph(const Deformation& d, const std::vector<double>& weights, Mesh* mesh) {
  for (size_t t = 0; t < d.primitive.targets.size() && t < weights.size(); ++t) {
    if (weights[t] == 0) continue;
    for (const auto& [name, index] : d.primitive.targets[t]) {
      const bool uv = name.starts_with("TEXCOORD_") && name.size() == 10 && name[9] >= '0' &&
                      name[9] < '0' + kUvSets;
      if (!uv && name != "POSITION" && name != "COLOR_0") continue;
      AccessorUse use;
      use.zeros = std::max<uint64_t>(use.zeros, d.vertices);
      const Accessor deltas(d.context, index, concat(d.source.place(), ".targets[", t, "].", name),
                            use);
      if (uv) {
        add_displacements(deltas, weights[t], 2, d, &mesh->uvs[static_cast<size_t>(name[9] - '0')]);
      } else {
        add_displacements(deltas, weights[t], 3, d,
                          name == "POSITION" ? &mesh->positions : &mesh->colors);
      }
    }
  }
  for (Rgb& color : mesh->colors) color = min(max(color, {0, 0, 0}), {1, 1, 1});
}

void apply_skin(const Deformation& d, const std::vector<Affine>& joints, Mesh* mesh) {
  const Influences influences = read_influences(d);
  std::vector<bool> mirrored(mesh->positions.size());
  for (size_t i = 0; i < mesh->positions.size(); ++i) {
    const size_t vertex = d.kept.empty() ? i : d.kept[i];
    const Blend matrix = blend(influences, vertex, joints);
    mesh->positions[i] = transform(matrix, mesh->positions[i]);
    LTE_CHECK(is_finite(mesh->positions[i]), d.context.file.name, ": ", d.source.place(),
              ": vertex ", vertex, " is not finite once skinned");
    mirrored[i] = determinant(matrix) < 0;
  }
  for (std::array<uint32_t, 3>& corner : mesh->triangles) {
    if (mirrored[corner[0]] && mirrored[corner[1]] && mirrored[corner[2]])
      std::swap(corner[1], corner[2]);
  }
}

}  // namespace lte::scene::gltf
