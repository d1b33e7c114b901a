// Meshes from Shape directives.
#include <algorithm>
#include <cmath>

#include "lte/scene/import/subdivision.h"
#include "lte/scene/pbrt/named_file.h"
#include "lte/scene/pbrt/world.h"
#include "lte/scene/ply/ply.h"

namespace lte::scene::pbrt {
namespace {

/// A patch is flat if its fourth corner lies this close to the plane of a parallelogram, over its
/// size; two triangles are exact then.
constexpr double kFlatness = 1e-5;
/// Cells a side of the grid that a bent patch becomes. Patch and grid are apart by 1/1024 of
/// |p00 - p10 - p01 + p11| at most.
constexpr int kPatchCells = 16;

void flip(Mesh* mesh) {
  for (std::array<uint32_t, 3>& triangle : mesh->triangles) std::swap(triangle[1], triangle[2]);
}

/// pbrt turns each triangle's front to where its shading normals point.
void face_normals(const std::vector<Vec3>& normals, Mesh* mesh) {
  for (std::array<uint32_t, 3>& triangle : mesh->triangles) {
    const Vec3 &a = mesh->positions[triangle[0]], &b = mesh->positions[triangle[1]],
               &c = mesh->positions[triangle[2]];
    const Vec3 shading = normals[triangle[0]] + normals[triangle[1]] + normals[triangle[2]];
    if (dot(cross(b - a, c - a), shading) < 0) std::swap(triangle[1], triangle[2]);
  }
}

void check_count(const Params& params, const char* name, size_t count, size_t vertices) {
  if (count != 0 && count != vertices)
    fail(params.at(), params.what(), ": ", count, " values of ", quote(name), " for ", vertices,
         " vertices");
}

/// "P", "N", "uv" and "indices", whose number is a multiple of `corners`.
std::vector<uint32_t> read_vertices(const Params& params, size_t corners, Mesh* mesh,
                                    std::vector<Vec3>* normals) {
  mesh->positions = params.points("P");
  if (mesh->positions.empty()) fail(params.at(), params.what(), " needs \"point3 P\"");
  *normals = params.points("N");
  mesh->uvs[0] = params.points2(params.has("uv") ? "uv" : "st");
  check_count(params, "N", normals->size(), mesh->positions.size());
  check_count(params, "uv", mesh->uvs[0].size(), mesh->positions.size());
  std::vector<uint32_t> indices = params.indices("indices", mesh->positions.size());
  if (indices.empty()) {
    // One triangle or patch may leave them out.
    if (mesh->positions.size() != corners || params.has("indices"))
      fail(params.at(), params.what(), " needs \"integer indices\"");
    for (uint32_t i = 0; i < corners; ++i) indices.push_back(i);
  }
  if (indices.size() % corners != 0)
    fail(params.at(), params.what(), ": ", indices.size(), " indices, not a multiple of ", corners);
  return indices;
}

BuiltShape build_triangles(const Params& params) {
  BuiltShape out;
  std::vector<Vec3> normals;
  const std::vector<uint32_t> indices = read_vertices(params, 3, &out.mesh, &normals);
  for (size_t i = 0; i < indices.size(); i += 3)
    out.mesh.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  if (!normals.empty()) face_normals(normals, &out.mesh);
  out.parts = static_cast<int64_t>(out.mesh.triangles.size());
  for (const char* harmless : {"S", "faceIndices"}) params.has(harmless);  // change nothing here
  return out;
}

template <typename T>
T bilerp(const T& p00, const T& p10, const T& p01, const T& p11, float u, float v) {
  return (p00 * (1 - u) + p10 * u) * (1 - v) + (p01 * (1 - u) + p11 * u) * v;
}

/// Appends the grid of one patch. Corners in pbrt's order: p00, p10, p01, p11.
void append_patch(const std::array<Vec3, 4>& p, const std::array<Vec2, 4>& uv, Mesh* mesh) {
  const Vec3 bend = p[0] - p[1] - p[2] + p[3];
  const float size = length(p[1] - p[0]) + length(p[2] - p[0]);
  const int cells = length(bend) <= kFlatness * size ? 1 : kPatchCells;
  const auto first = static_cast<uint32_t>(mesh->positions.size());
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(cells),
                  v = static_cast<float>(j) / static_cast<float>(cells);
      mesh->positions.push_back(bilerp(p[0], p[1], p[2], p[3], u, v));
      const auto lift = [](const Vec2& t) { return Vec3{t.x, t.y, 0}; };
      const Vec3 t = bilerp(lift(uv[0]), lift(uv[1]), lift(uv[2]), lift(uv[3]), u, v);
      mesh->uvs[0].push_back({t.x, t.y});
    }
  }
  const auto row = static_cast<uint32_t>(cells + 1);
  for (uint32_t j = 0; j + 1 < row; ++j) {
    for (uint32_t i = 0; i + 1 < row; ++i) {
      const uint32_t a = first + j * row + i;
      mesh->triangles.push_back({a, a + 1, a + row + 1});
      mesh->triangles.push_back({a, a + row + 1, a + row});
    }
  }
}

BuiltShape build_patches(const Params& params, const LoadLimits& limits, IgnoredFeatures* ignored) {
  Mesh control;
  std::vector<Vec3> normals;
  const std::vector<uint32_t> indices = read_vertices(params, 4, &control, &normals);
  BuiltShape out;
  out.parts = static_cast<int64_t>(indices.size() / 4);
  if (out.parts > limits.triangles / (2 * kPatchCells * kPatchCells))
    throw OverLimit(concat(params.at(), ": ", params.what(), ": ", out.parts,
                           " patches may have more than ", limits.triangles, " triangles"),
                    "triangles", out.parts * 2 * kPatchCells * kPatchCells);
  for (size_t i = 0; i < indices.size(); i += 4) {
    std::array<Vec3, 4> corners;
    std::array<Vec2, 4> uvs{Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}, Vec2{1, 1}};
    Vec3 shading;
    for (size_t k = 0; k < 4; ++k) {
      corners[k] = control.positions[indices[i + k]];
      if (!control.uvs[0].empty()) uvs[k] = control.uvs[0][indices[i + k]];
      if (!normals.empty()) shading += normals[indices[i + k]];
    }
    const size_t first = out.mesh.triangles.size();
    append_patch(corners, uvs, &out.mesh);
    const Vec3 front = cross(corners[1] - corners[0] + corners[3] - corners[2],
                             corners[2] - corners[0] + corners[3] - corners[1]);
    if (dot(front, shading) >= 0) continue;
    for (size_t t = first; t < out.mesh.triangles.size(); ++t)
      std::swap(out.mesh.triangles[t][1], out.mesh.triangles[t][2]);
  }
  if (params.has("emissionfilename"))
    ignored->add("parameter \"emissionfilename\" of Shape \"bilinearmesh\"", params.at());
  return out;
}

BuiltShape build_ply(const Params& params, const Files& files, IgnoredFeatures* ignored) {
  const std::string name = params.text("filename", "");
  if (name.empty()) fail(params.at(), params.what(), " needs \"string filename\"");
  const SceneFilePtr file = files.find(name, params.at());
  ply::PlyMesh ply = at_line(params.at(), [&] { return ply::read_ply(file, &files.budget()); });
  BuiltShape out;
  out.parts = ply.faces - ply.dropped_faces;
  out.mesh.name = file->path().stem().string();
  out.mesh.positions = std::move(ply.positions);
  out.mesh.triangles = std::move(ply.triangles);
  out.mesh.uvs[0] = std::move(ply.uvs);
  if (!ply.normals.empty()) face_normals(ply.normals, &out.mesh);
  if (ply.dropped_faces > 0) ignored->add("face of fewer than 3 corners in a plymesh", params.at());
  return out;
}

BuiltShape build_loop(const Params& params, const LoadLimits& limits) {
  Mesh control;
  std::vector<Vec3> normals;
  const std::vector<uint32_t> indices = read_vertices(params, 3, &control, &normals);
  const int levels = params.integer(params.has("nlevels") ? "nlevels" : "levels", 3);
  params.has("scheme");
  double triangles = static_cast<double>(indices.size()) / 3;
  for (int i = 0; i < levels && triangles <= 1e18; ++i) triangles *= 4;
  if (levels < 0) fail(params.at(), params.what(), ": ", levels, " levels");
  if (triangles > static_cast<double>(limits.triangles))
    throw OverLimit(concat(params.at(), ": ", params.what(), ": ", levels, " levels make ",
                           triangles, " triangles; the limit is ", limits.triangles),
                    "triangles");
  TriangleMesh mesh{std::move(control.positions), {}};
  for (size_t i = 0; i < indices.size(); i += 3)
    mesh.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  const std::string where = concat(params.at(), ": ", params.what());
  try {
    mesh = loop_subdivide(mesh, levels, where);
  } catch (const Error&) {
    if (params.at().file->outside) fail(params.at(), params.what(), ": cannot be subdivided");
    throw;
  }
  BuiltShape out;
  out.mesh.positions = std::move(mesh.positions);
  out.mesh.triangles = std::move(mesh.triangles);
  out.parts = static_cast<int64_t>(out.mesh.triangles.size());
  // pbrt orients the surface by normals that it computes along rings that run clockwise: against
  // the winding.
  flip(&out.mesh);
  return out;
}

}  // namespace

BuiltShape build_shape(const std::string& type, const Params& params, bool reverse,
                       const Files& files, IgnoredFeatures* ignored) {
  const LoadLimits& limits = files.limits();
  BuiltShape out;
  if (type == "trianglemesh") {
    out = build_triangles(params);
  } else if (type == "plymesh") {
    out = build_ply(params, files, ignored);
  } else if (type == "loopsubdiv") {
    out = build_loop(params, limits);
  } else if (type == "bilinearmesh") {
    out = build_patches(params, limits, ignored);
  } else if (type == "sphere") {
    out.mesh = make_sphere(params);
  } else if (type == "cylinder") {
    out.mesh = make_cylinder(params);
  } else if (type == "disk") {
    out.mesh = make_disk(params);
  } else {
    ignored->add("Shape " + quote(type), params.at());
    return out;
  }
  ignore_left_out(params, ignored);
  if (reverse) flip(&out.mesh);
  return out;
}

void ignore_left_out(const Params& params, IgnoredFeatures* ignored) {
  for (const char* name : {"alpha", "shadowalpha"}) {
    if (params.has(name)) ignored->add("alpha of a shape", params.at());
  }
  ignore_unused(params, ignored);
}

void ignore_unused(const Params& params, IgnoredFeatures* ignored) {
  for (const Parameter* parameter : params.unused())
    ignored->add("parameter " + quote(parameter->name) + " of " + params.what(), parameter->at);
}

}  // namespace lte::scene::pbrt
