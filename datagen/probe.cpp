#include "datagen/probe.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <span>
#include <sstream>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/progress.h"
#include "lte/base/random.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/lights.h"

namespace lte::datagen {
namespace {

constexpr const char* kHeader = "px,py,pz,nx,ny,nz";
constexpr const char* kColumns[6] = {"px", "py", "pz", "nx", "ny", "nz"};
constexpr int64_t kPilotRays = 64;
constexpr int64_t kBlock = 4096;
/// The pilot knows the variance only roughly; this much more keeps most points below the target.
constexpr double kSafety = 1.3;

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

float parse_number(const std::string& where, const char* column, const std::string& field) {
  char* end = nullptr;
  const double value = std::strtod(field.c_str(), &end);
  while (*end == ' ' || *end == '\t') ++end;
  LTE_CHECK(!field.empty() && end != field.c_str() && *end == '\0', where, ", column ", column,
            ": expected a number, got \"", field, "\"");
  LTE_CHECK(std::isfinite(static_cast<float>(value)), where, ", column ", column, ": ", field,
            " is not a finite float32");
  return static_cast<float>(value);
}

struct Tracer {
  pathtrace::Bvh bvh;
  pathtrace::Lights lights;
  const ProbePoints& points;
  ProbeResult& result;

  /// Estimates `which` points with `rays` paths and stores the outcome.
  void run(const std::vector<size_t>& which, int64_t rays, int max_depth, uint64_t seed,
           Progress* progress) {
    pathtrace::IrradianceOptions options;
    options.rays = static_cast<int>(rays);
    options.max_depth = max_depth;
    options.seed = seed;
    for (size_t first = 0; first < which.size(); first += kBlock) {
      const size_t count = std::min<size_t>(kBlock, which.size() - first);
      std::vector<Vec3> position, normal;
      for (size_t i = 0; i < count; ++i) {
        position.push_back(points.position[which[first + i]]);
        normal.push_back(points.normal[which[first + i]]);
      }
      const auto block = pathtrace::estimate_irradiance(bvh, lights, position, normal, options,
                                                        static_cast<int64_t>(first));
      for (size_t i = 0; i < count; ++i) {
        const size_t at = which[first + i];
        const auto local = static_cast<int64_t>(i);
        const Rgb& variance = block.variance_total[i];
        result.total[at] = block.total(local);
        result.direct[at] = block.direct_sum(local);
        result.standard_error[at] = {std::sqrt(variance.x), std::sqrt(variance.y),
                                     std::sqrt(variance.z)};
        result.rays[at] = block.rays;
      }
      progress->advance(static_cast<int64_t>(count));
    }
  }
};

/// Standard error over mean, both averaged over colour; infinite where nothing has arrived yet.
double relative_error(const ProbeResult& result, size_t i) {
  const Rgb &total = result.total[i], &error = result.standard_error[i];
  const double mean = total.x + total.y + total.z;
  return mean > 0 ? (error.x + error.y + error.z) / mean : INFINITY;
}

/// The rays that the pilot's error asks for: a power of two, so that points share runs.
int64_t wanted_rays(const ProbeResult& pilot, size_t i, const ProbeOptions& options) {
  const double ratio = relative_error(pilot, i) / options.target_error;
  const double rays = kSafety * static_cast<double>(pilot.rays[i]) * ratio * ratio;
  if (!(rays < static_cast<double>(options.rays))) return options.rays;
  const auto rounded = std::bit_ceil(static_cast<uint64_t>(std::max<double>(rays, kPilotRays)));
  return std::min(options.rays, static_cast<int64_t>(rounded));
}

}  // namespace

ProbePoints read_probe_points(const std::filesystem::path& path) {
  std::istringstream text(read_file(path));
  ProbePoints points;
  std::string line;
  for (int64_t number = 1; std::getline(text, line); ++number) {
    const std::string where = concat(path.string(), ": line ", number);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1) {
      LTE_CHECK(line == kHeader, where, ": expected the header \"", kHeader, "\", got \"",
                line.substr(0, 80), "\"");
      continue;
    }
    if (line.empty()) continue;
    const std::vector<std::string> fields = split(line);
    LTE_CHECK(fields.size() <= 6, where, ", column ", 7, ": expected 6 columns, got ",
              fields.size());
    LTE_CHECK(fields.size() == 6, where, ", column ", kColumns[fields.size()], ": missing");
    float values[6];
    for (size_t c = 0; c < 6; ++c) values[c] = parse_number(where, kColumns[c], fields[c]);
    const Vec3 normal{values[3], values[4], values[5]};
    LTE_CHECK(length(normal) > 1e-6f && std::isfinite(length(normal)), where,
              ", columns nx,ny,nz: the normal has no length");
    points.lines.push_back(line);
    points.position.push_back({values[0], values[1], values[2]});
    points.normal.push_back(normalize(normal));
  }
  LTE_CHECK(!points.lines.empty(), path.string(), ": no points; expected the header \"", kHeader,
            "\" and one line a point");
  return points;
}

ProbeResult probe(const scene::Scene& scene, const ProbePoints& points,
                  const ProbeOptions& options) {
  LTE_CHECK(options.rays >= 1 && options.rays <= 1 << 30, "--rays: expected 1 to ", 1 << 30,
            ", got ", options.rays);
  LTE_CHECK(options.max_depth >= 1 && options.max_depth <= 1000,
            "--max-depth: expected 1 to 1000, got ", options.max_depth);
  LTE_CHECK(options.target_error >= 0 && std::isfinite(options.target_error),
            "--target-error: expected a number that is not negative, got ", options.target_error);
  const size_t N = points.position.size();
  ProbeResult result;
  result.total.resize(N);
  result.direct.resize(N);
  result.standard_error.resize(N);
  result.rays.resize(N);
  std::vector<size_t> all(N);
  for (size_t i = 0; i < N; ++i) all[i] = i;
  Tracer tracer{pathtrace::Bvh(scene), pathtrace::Lights(scene), points, result};

  if (options.target_error == 0) {
    Progress progress("probing", static_cast<int64_t>(N), "points");
    tracer.run(all, options.rays, options.max_depth, hash_combine(options.seed, 2), &progress);
    return result;
  }
  {
    Progress progress("pilot", static_cast<int64_t>(N), "points");
    tracer.run(all, std::min(kPilotRays, options.rays), options.max_depth,
               hash_combine(options.seed, 1), &progress);
  }
  std::map<int64_t, std::vector<size_t>> runs;
  for (size_t i = 0; i < N; ++i) runs[wanted_rays(result, i, options)].push_back(i);
  Progress progress("probing", static_cast<int64_t>(N), "points");
  for (const auto& [rays, which] : runs)
    tracer.run(which, rays, options.max_depth,
               hash_combine(options.seed, 2 + static_cast<uint64_t>(rays)), &progress);
  for (size_t i = 0; i < N; ++i) {
    // No light at all after every ray that was allowed is an answer, not a miss.
    const bool dark = result.total[i] == Rgb{};
    if (!dark && relative_error(result, i) > options.target_error) ++result.missed;
  }
  return result;
}

void write_probe_result(const std::filesystem::path& path, const ProbePoints& points,
                        const ProbeResult& result) {
  AtomicFile file(path);
  file.write(concat(
      kHeader,
      ",total_r,total_g,total_b,direct_r,direct_g,direct_b,stderr_r,stderr_g,stderr_b,rays\n"));
  for (size_t i = 0; i < points.lines.size(); ++i) {
    std::string line = points.lines[i];
    for (const Rgb& value : {result.total[i], result.direct[i], result.standard_error[i]}) {
      for (int c = 0; c < 3; ++c) {
        char text[32];
        std::snprintf(text, sizeof text, ",%.9g", static_cast<double>(value[c]));
        line += text;
      }
    }
    file.write(concat(line, ",", result.rays[i], "\n"));
  }
  file.commit();
}

}  // namespace lte::datagen
