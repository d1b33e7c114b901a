#include "lte/pathtrace/bvh.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>

#include "lte/base/check.h"
#include "lte/base/cpu_isa.h"
#include "lte/base/parallel.h"
#include "lte/pathtrace/blocks/ray_packets.h"
#include "lte/pathtrace/embree_scene.h"
#include "lte/scene/inverse_transpose.h"
#include "lte/scene/number_check.h"
#include "lte/scene/shading_normal.h"
#include "lte/scene/surface.h"

namespace lte::pathtrace {
namespace {

void check_device(RTCDevice device, const char* what) {
  const RTCError error = rtcGetDeviceError(device);
  LTE_CHECK(error == RTC_ERROR_NONE, "Embree failed while ", what, ": ",
            error == RTC_ERROR_OUT_OF_MEMORY ? "out of memory" : "error ",
            error == RTC_ERROR_OUT_OF_MEMORY ? std::string() : std::to_string(error));
}

/// max_isa, unlike isa, is no error where the processor has less.
std::string device_settings() {
  std::string threads = "threads=" + std::to_string(num_threads());
  const std::string isa = wanted_cpu_isa();
  if (isa == "avx2") return threads + ",max_isa=avx2";
  if (isa == "baseline") return threads + ",max_isa=sse2";
  return threads;
}

void set_indices(RTCGeometry geometry, const scene::Mesh& mesh, bool own) {
  const size_t size = sizeof(mesh.triangles[0]), count = mesh.triangles.size();
  if (!own) {
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh.triangles.data(), 0, size, count);
    return;
  }
  void* indices =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, size, count);
  if (indices == nullptr) rtcReleaseGeometry(geometry);
  LTE_CHECK(indices != nullptr, "Embree failed: no memory for the ", count, " triangles of mesh ",
            mesh.name);
  std::memcpy(indices, mesh.triangles.data(), size * count);
}

/// Embree reads 16 bytes at each 12-byte vertex, so the last one would be read past its vector:
/// Embree keeps a padded copy of the positions and, unless it is to own them, shares the indices,
/// three times as large.
RTCGeometry make_geometry(RTCDevice device, const scene::Mesh& mesh, bool own_indices) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Vec3), mesh.positions.size());
  if (vertices == nullptr) rtcReleaseGeometry(geometry);
  LTE_CHECK(vertices != nullptr, "Embree failed: no memory for the ", mesh.positions.size(),
            " vertices of mesh ", mesh.name);
  std::memcpy(vertices, mesh.positions.data(), mesh.positions.size() * sizeof(Vec3));
  set_indices(geometry, mesh, own_indices);
  rtcCommitGeometry(geometry);
  return geometry;
}

const float* positions_of(RTCGeometry geometry) {
  return static_cast<const float*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
}

RTCScene build_mesh(RTCDevice device, const scene::Mesh& mesh, bool own_indices) {
  RTCGeometry geometry = make_geometry(device, mesh, own_indices);
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return scene;
}

/// A mesh that stands in the frame as it is: rays need not enter a tree of its own, and meet it at
/// the same places to the last bit.
const float* attach_flat(Bvh::Handles* handles, int index, const scene::Mesh& mesh) {
  RTCGeometry geometry = make_geometry(handles->device, mesh, /*own_indices=*/false);
  const float* positions = positions_of(geometry);
  rtcAttachGeometryByID(handles->top, geometry, static_cast<unsigned>(index));
  rtcReleaseGeometry(geometry);
  return positions;
}

/// False if the transform is singular or not finite.
bool normal_transform(const Affine& transform, std::array<Vec3, 3>* rows) {
  const std::optional<scene::Matrix3> inverse = scene::inverse_transpose(transform);
  if (!inverse) return false;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      (*rows)[i][j] =
          static_cast<float>((*inverse)[static_cast<size_t>(i)][static_cast<size_t>(j)]);
    }
    if (!is_finite((*rows)[i])) return false;
  }
  return true;
}

/// The instance's transform, but to the frame.
Affine to_frame(const scene::Instance& instance, const Vec3& origin) {
  Affine out = instance.to_world;
  for (int row = 0; row < 3; ++row)
    out.m[row][3] = static_cast<float>(static_cast<double>(out.m[row][3]) - origin[row]);
  return out;
}

Float4 column(const auto& rows, int k) {
  const float x = rows[0][k], y = rows[1][k], z = rows[2][k];
  return Float4{x, y, z, 0};
}

InstanceRecord make_record(const scene::Scene& scene, int index, const Vec3& origin) {
  InstanceRecord record;
  const scene::Instance& instance = scene.instances[index];
  const scene::Mesh& mesh = scene.meshes[instance.mesh];
  std::array<Vec3, 3> normal_rows;
  if (mesh.triangles.empty() || !normal_transform(instance.to_world, &normal_rows) ||
      scene::inverse_stretch(instance.to_world) > 1 / scene::kMinScale) {
    return record;
  }
  record.triangles = mesh.triangles.data();
  const Affine transform = to_frame(instance, origin);
  for (int k = 0; k < 4; ++k) record.columns[k] = column(transform.m, k);
  for (int k = 0; k < 3; ++k) record.normal_columns[k] = column(normal_rows, k);
  for (const auto& row : transform.m) {
    record.scale =
        std::max(record.scale, std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]));
    record.translation = std::max(record.translation, std::fabs(row[3]));
  }
  const scene::Material& material = scene.materials[mesh.material];
  scene::evaluate_appearance(scene, index, 0, 0, 0, 0, &record.albedo, &record.emission);
  record.gloss = scene::evaluate_gloss(scene, index, 0, 0, 0, 0);
  record.uniform = material.base_color_texture.texture == scene::kNone &&
                   material.emission_texture.texture == scene::kNone &&
                   material.metallic_roughness_texture.texture == scene::kNone &&
                   mesh.colors.empty();
  record.glossy = material.metallic > 0;
  record.normal_mapped = scene::has_normal_map(scene, instance);
  record.emissive = material.emissive();
  record.two_sided = material.double_sided;
  record.light_group = instance.light_group;
  return record;
}

void attach_instance(Bvh::Handles* handles, int index, int mesh, const Affine& transform) {
  RTCGeometry geometry = rtcNewGeometry(handles->device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, handles->meshes[mesh]);
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, transform.m.data());
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(handles->top, geometry, static_cast<unsigned>(index));
  rtcReleaseGeometry(geometry);
}

}  // namespace

Bvh::Handles::~Handles() {
  if (top != nullptr) rtcReleaseScene(top);
  for (RTCScene mesh : meshes) {
    if (mesh != nullptr) rtcReleaseScene(mesh);
  }
  if (device != nullptr) rtcReleaseDevice(device);
}

Bvh::Bvh(const scene::Scene& scene) : Bvh(scene, Indices::Borrowed) {}

Bvh::Bvh(const scene::Scene& scene, Indices indices)
    : scene_(scene), bounds_(scene.bounds()), handles_(std::make_unique<Handles>()) {
  start();
  handles_->own_indices = indices == Indices::Own;
  handles_->meshes.resize(scene.meshes.size(), nullptr);
  attach_all(indices);
}

Bvh::Bvh(const scene::Scene& scene, const Bvh& trees, std::span<const int> tree_of_mesh)
    : scene_(scene), bounds_(scene.bounds()), handles_(std::make_unique<Handles>()) {
  Handles& h = *handles_;
  const Handles& from = trees.handles();
  LTE_CHECK(from.own_indices && tree_of_mesh.size() == scene.meshes.size(),
            "a tree on the meshes of another: expected one that owns them, and ",
            scene.meshes.size(), " numbers of meshes, got ", tree_of_mesh.size());
  h.own_indices = true;
  h.device = from.device;
  rtcRetainDevice(h.device);
  start();
  for (const int mesh : tree_of_mesh) {
    h.meshes.push_back(from.meshes.at(static_cast<size_t>(mesh)));
    if (h.meshes.back() != nullptr) rtcRetainScene(h.meshes.back());
  }
  attach_all(Indices::Own);
}

std::unique_ptr<Bvh> Bvh::with_own_meshes(const scene::Scene& scene) {
  return std::unique_ptr<Bvh>(new Bvh(scene, Indices::Own));
}

/// Checks where the scene lies, and opens what its trees go into.
void Bvh::start() {
  Handles& h = *handles_;
  LTE_CHECK(bounds_.empty() || (scene::is_place(bounds_.low) && scene::is_place(bounds_.high)),
            "the scene reaches farther than ", scene::kMaxCoordinate, " from the origin");
  h.origin = frame_origin(bounds_);
  if (h.device == nullptr) h.device = rtcNewDevice(device_settings().c_str());
  LTE_CHECK(h.device != nullptr, "Embree failed to start: error ", rtcGetDeviceError(nullptr));
  h.packet_width = native_packet_width(h.device);
  h.top = rtcNewScene(h.device);
  rtcSetSceneFlags(h.top, RTC_SCENE_FLAG_ROBUST);
}

/// Builds the meshes' trees that are missing, and the tree over the instances. Triangles of meshes
/// that are borrowed, stand in the scene once and are not moved go into that tree themselves.
void Bvh::attach_all(Indices indices) {
  Handles& h = *handles_;
  h.instances.reserve(scene_.instances.size());
  std::vector<int> uses(scene_.meshes.size());
  for (const scene::Instance& instance : scene_.instances) ++uses[instance.mesh];
  for (size_t i = 0; i < scene_.instances.size(); ++i) {
    const int mesh = scene_.instances[i].mesh;
    h.instances.push_back(make_record(scene_, static_cast<int>(i), h.origin));
    InstanceRecord& record = h.instances.back();
    if (record.triangles == nullptr) continue;
    const Affine transform = to_frame(scene_.instances[i], h.origin);
    if (indices == Indices::Borrowed && uses[mesh] == 1 && transform.m == Affine().m) {
      record.positions = attach_flat(&h, static_cast<int>(i), scene_.meshes[mesh]);
      continue;
    }
    if (h.meshes[mesh] == nullptr)
      h.meshes[mesh] = build_mesh(h.device, scene_.meshes[mesh], indices == Indices::Own);
    record.positions = positions_of(rtcGetGeometry(h.meshes[mesh], 0));
    attach_instance(&h, static_cast<int>(i), mesh, transform);
  }
  rtcCommitScene(h.top);
  check_device(h.device, "building the bounding volume hierarchy");
}

Bvh::~Bvh() = default;

Hit Bvh::intersect(const Ray& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query;
  set_ray(&query.ray, ray.origin - handles_->origin, ray.direction, ray.t_min, ray.t_max);
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(handles_->top, &context, &query);
  Hit hit;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.t = query.ray.tfar;
  hit.instance = static_cast<int>(instance_of(query.hit.instID[0], query.hit.geomID));
  hit.triangle = query.hit.primID;
  hit.u = query.hit.u;
  hit.v = query.hit.v;
  hit.normal = frame_normal(handles_->instances[hit.instance],
                            {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z});
  return hit;
}

bool Bvh::occluded(const Ray& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay query;
  set_ray(&query, ray.origin - handles_->origin, ray.direction, ray.t_min, ray.t_max);
  rtcOccluded1(handles_->top, &context, &query);
  return query.tfar < 0;
}

Vec3 frame_origin(const Bounds& bounds) {
  if (bounds.empty()) return {};
  const Vec3 center = bounds.center();
  const bool far_off = max_component(abs(center)) > 4 * max_component(bounds.extent());
  return far_off && is_finite(center) ? center : Vec3{};
}

}  // namespace lte::pathtrace
