#include "lte/bake/formats/probe_files.h"

#include <array>
#include <cstdlib>
#include <string>

#include <nlohmann/json.hpp>

#include "lte/base/math.h"
#include "lte/base/text.h"
#include "lte/image/exr.h"
#include "lte/image/image.h"

namespace lte::bake {
namespace {

using Json = nlohmann::ordered_json;

/// With the digits that a float has: the EXR is exact.
double rounded(float value) { return std::strtod(formatted("%.7g", value).c_str(), nullptr); }

Json to_json_rgb(const Vec3& v) { return {rounded(v.x), rounded(v.y), rounded(v.z)}; }

/// A picture with a pixel a probe.
template <typename ValueOf>
image::Image probe_picture(const ProbeVolume& volume, const ValueOf& value_of) {
  const auto [x, y, z] = volume.grid.counts;
  image::Image out(x, y * z, 3);
  for (size_t i = 0; i < volume.probes.size(); ++i) out.set_rgb(i, value_of(volume.probes[i]));
  return out;
}

void write_probes_exr(const std::filesystem::path& path, const ProbeVolume& volume) {
  std::vector<std::pair<std::string, image::Image>> pictures;
  for (size_t k = 0; k < kShCoefficients; ++k) {
    pictures.emplace_back(concat("sh", k), probe_picture(volume, [&](const Probe& probe) {
                            return probe.radiance[k];
                          }));
  }
  constexpr std::array<const char*, kCubeSides> kSides{"nx", "px", "ny", "py", "nz", "pz"};
  for (size_t side = 0; side < kCubeSides; ++side) {
    pictures.emplace_back(concat("cube_", kSides[side]), probe_picture(volume, [&](const Probe& p) {
                            return p.irradiance[side];
                          }));
    pictures.emplace_back(concat("depth_", kSides[side]),
                          probe_picture(volume, [&](const Probe& p) {
                            return Vec3{p.distance[side], p.distance2[side], 0};
                          }));
  }
  pictures.emplace_back("validity", probe_picture(volume, [](const Probe& probe) {
                          return Vec3{probe.valid ? 1.0f : 0.0f, probe.back_faces, 0};
                        }));
  std::vector<image::Layer> layers;
  layers.reserve(pictures.size());
  for (const auto& [name, picture] : pictures) layers.push_back({name, &picture});
  image::write_exr(path, layers);
}

Json probe_json(const ProbeVolume& volume, int64_t number) {
  const Probe& probe = volume.probes[static_cast<size_t>(number)];
  Json out{{"position", to_json_rgb(volume.grid.position(number))},
           {"valid", probe.valid},
           {"back_faces", rounded(probe.back_faces)}};
  for (const Rgb& value : probe.radiance) out["sh"].push_back(to_json_rgb(value));
  for (const Rgb& value : probe.irradiance) out["cube"].push_back(to_json_rgb(value));
  for (size_t side = 0; side < kCubeSides; ++side) {
    out["distance"].push_back(rounded(probe.distance[side]));
    out["distance2"].push_back(rounded(probe.distance2[side]));
  }
  return out;
}

}  // namespace

void write_probes(const ProbeVolume& volume, FileSet* files) {
  files->write("probes.exr",
               [&](const std::filesystem::path& path) { write_probes_exr(path, volume); });
  Json json{{"schema_version", 1},
            {"image", "probes.exr"},
            {"counts", volume.grid.counts},
            {"low", to_json_rgb(volume.grid.bounds.low)},
            {"high", to_json_rgb(volume.grid.bounds.high)},
            {"invalid", volume.invalid},
            {"sh",
             "coefficients of radiance, W sr^-1 m^-2: real orthonormal harmonics Y00, y, z, "
             "x, xy, yz, 3zz-1, xz, xx-yy"},
            {"cube", "irradiance on the sides -x, +x, -y, +y, -z, +z, W/m^2"},
            {"distance", "mean metres to surfaces by side; distance2: of the square"}};
  for (int64_t i = 0; i < volume.grid.size(); ++i) json["probes"].push_back(probe_json(volume, i));
  files->write("probes.json", json.dump() + "\n");
}

image::Ktx2 bevy_volume(const ProbeVolume& volume) {
  const auto [rx, ry, rz] = volume.grid.counts;
  image::Ktx2 out{image::Ktx2Format::Rgb9e5, rx, 2 * ry, 3 * rz, /*layers=*/0, {}};
  out.texels.resize(volume.probes.size() * kCubeSides);
  for (size_t i = 0; i < volume.probes.size(); ++i) {
    const int x = static_cast<int>(i) % rx, y = static_cast<int>(i) / rx % ry,
              z = static_cast<int>(i) / (rx * ry);
    for (int side = 0; side < kCubeSides; ++side) {
      const bool positive = side % 2 == 1;
      const int row = y + (positive ? 0 : ry), slice = z + side / 2 * rz;
      out.texels[(static_cast<size_t>(slice) * out.height + row) * out.width + x] =
          volume.probes[i].irradiance[static_cast<size_t>(side)] * (1 / kPi);
    }
  }
  return out;
}

}  // namespace lte::bake
