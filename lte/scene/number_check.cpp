#include "lte/scene/number_check.h"

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "lte/base/check.h"
#include "lte/scene/inverse_transpose.h"

namespace lte::scene {
namespace {

std::string shown(const Vec3& v) { return concat("(", v.x, ", ", v.y, ", ", v.z, ")"); }

/// Of |M| without the translation.
double largest_row_sum(const Affine& transform) {
  double largest = 0;
  for (const auto& row : transform.m) {
    double sum = 0;
    for (int column = 0; column < 3; ++column) sum += std::abs(double{row[column]});
    largest = std::max(largest, sum);
  }
  return largest;
}

/// Of all vertices in the world, as a box in the frame of the mesh says it; holes are not known.
bool all_corners_are_places(const Bounds& box, const Affine& to_world) {
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p{(corner & 1 ? box.high : box.low).x, (corner & 2 ? box.high : box.low).y,
                 (corner & 4 ? box.high : box.low).z};
    if (!is_place(to_world.point(p))) return false;
  }
  return true;
}

std::optional<uint32_t> vertex_out_of_place(const Mesh& mesh, const Affine& to_world) {
  for (const auto& triangle : mesh.triangles) {
    for (const uint32_t vertex : triangle) {
      if (!is_place(to_world.point(mesh.positions[vertex]))) return vertex;
    }
  }
  return std::nullopt;
}

void check_instance(const std::string& file, const Instance& instance, const Mesh& mesh,
                    const Bounds& box) {
  const Affine& to_world = instance.to_world;
  if (mesh.triangles.empty() || box.empty()) return;
  const auto where = [&] { return concat(file, ": mesh \"", mesh.name, "\""); };
  if (!all_corners_are_places(box, to_world)) {
    if (const auto vertex = vertex_out_of_place(mesh, to_world)) {
      throw Error(concat(where(), ": vertex ", *vertex, " lies at ",
                         shown(to_world.point(mesh.positions[*vertex])),
                         " in the world; expected coordinates of at most ", kMaxCoordinate));
    }
  }
  const Vec3 place = to_world.point({0, 0, 0});
  LTE_CHECK(is_place(place), where(), ": its node lies at ", shown(place),
            " in the world; expected coordinates of at most ", kMaxCoordinate);
  LTE_CHECK(largest_row_sum(to_world) <= kMaxScale, where(), ": its node scales by ",
            largest_row_sum(to_world), "; expected at most ", kMaxScale);
  const double stretch = inverse_stretch(to_world);
  if (stretch <= 1 / kMinScale || std::isinf(stretch)) return;
  const double extent = largest_row_sum(to_world) * max_component(box.extent());
  LTE_CHECK(extent <= kHiddenExtent, where(), ": its node scales by ", 1 / stretch,
            "; expected at least ", kMinScale);
}

void check_meshes(const std::string& file, const Scene& scene) {
  std::vector<Bounds> boxes(scene.meshes.size());
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    const Mesh& mesh = scene.meshes[i];
    for (const Vec3& p : mesh.positions) boxes[i].extend(p);
    for (size_t v = 0; v < mesh.colors.size(); ++v)
      LTE_CHECK(is_finite(mesh.colors[v]), file, ": mesh \"", mesh.name, "\": the color of vertex ",
                v, " is not finite");
  }
  for (const Instance& instance : scene.instances) {
    const auto mesh = static_cast<size_t>(instance.mesh);
    check_instance(file, instance, scene.meshes[mesh], boxes[mesh]);
  }
}

void check_materials(const std::string& file, const Scene& scene) {
  for (const Material& material : scene.materials) {
    const auto where = [&] { return concat(file, ": material \"", material.name, "\""); };
    LTE_CHECK(is_finite(material.base_color), where(), ": its base color is not finite");
    LTE_CHECK(is_radiance(material.emission), where(), ": its radiance is ",
              shown(material.emission), "; expected at most ", kMaxRadiance);
  }
}

void check_lights(const std::string& file, const Scene& scene) {
  for (const PunctualLight& light : scene.lights) {
    const auto where = [&] { return concat(file, ": light \"", light.name, "\""); };
    LTE_CHECK(light.kind == LightKind::Directional || is_place(light.position), where(),
              " lies at ", shown(light.position), "; expected coordinates of at most ",
              kMaxCoordinate);
    LTE_CHECK(is_finite(light.direction), where(), ": its direction is not finite");
    LTE_CHECK(is_radiance(light.intensity), where(), ": its intensity is ", shown(light.intensity),
              "; expected at most ", kMaxRadiance);
  }
  if (scene.environment) check_environment(concat(file, ": environment"), *scene.environment);
}

void check_cameras(const std::string& file, const Scene& scene) {
  for (const Camera& camera : scene.cameras) {
    LTE_CHECK(is_place(camera.origin) && is_place(camera.target), file, ": camera \"", camera.name,
              "\" lies at ", shown(camera.origin), "; expected coordinates of at most ",
              kMaxCoordinate);
  }
}

}  // namespace

double inverse_stretch(const Affine& transform) {
  const std::optional<Matrix3> inverse = inverse_transpose(transform);
  if (!inverse) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (size_t j = 0; j < 3; ++j) {  // row j of the inverse is column j of its transpose
    double sum = 0;
    for (size_t i = 0; i < 3; ++i) sum += std::abs((*inverse)[i][j]);
    largest = std::max(largest, sum);
  }
  return largest;
}

void check_numbers(const std::string& file, const Scene& scene) {
  check_meshes(file, scene);
  check_materials(file, scene);
  check_lights(file, scene);
  check_cameras(file, scene);
}

void check_environment(const std::string& what, const Environment& environment) {
  LTE_CHECK(is_radiance(environment.radiance), what, ": its radiance is ",
            shown(environment.radiance), "; expected at most ", kMaxRadiance);
  if (!environment.map) return;
  const EnvironmentMap& map = *environment.map;
  for (size_t i = 0; i < static_cast<size_t>(map.width()) * static_cast<size_t>(map.height());
       ++i) {
    LTE_CHECK(is_radiance(map.texel(i)) && is_radiance(environment.radiance * map.texel(i)), what,
              ": texel ", i % static_cast<size_t>(map.width()), ", ",
              i / static_cast<size_t>(map.width()), " of its picture has radiance ",
              shown(environment.radiance * map.texel(i)), "; expected at most ", kMaxRadiance);
  }
}

}  // namespace lte::scene
