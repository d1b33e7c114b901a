#include "datagen/commands/probe.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <span>
#include <sstream>
#include <string_view>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/random.h"
#include "lte/base/text.h"
#include "lte/cli/progress.h"
#include "lte/pathtrace/adaptive.h"
#include "lte/pathtrace/bvh.h"
#include "lte/pathtrace/irradiance.h"
#include "lte/pathtrace/lights.h"
#include "lte/scene/number_check.h"

namespace lte::datagen {
namespace {

constexpr const char* kHeader = "px,py,pz,nx,ny,nz";
constexpr const char* kColumns[6] = {"px", "py", "pz", "nx", "ny", "nz"};
/// What spreadsheets put before UTF-8.
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr int kPilotRays = 64;
constexpr size_t kBlock = 4096;  // points between two looks at the progress

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// The fields between commas, without the blanks around them.
std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  for (std::string& field : fields) field = trimmed(field);
  return fields;
}

/// The header's columns are the right ones in the right order.
void check_header(const std::string& where, const std::string& line) {
  const std::vector<std::string> names = split(line);
  for (size_t c = 0; c < 6; ++c) {
    const std::string got = c < names.size() ? names[c] : "";
    LTE_CHECK(got == kColumns[c], where, ", column ", c + 1, ": expected \"", kColumns[c],
              "\" of the header \"", kHeader, "\", got \"", got.substr(0, 80), "\"",
              line.find(';') != std::string::npos ? "; columns are separated by commas" : "");
  }
  LTE_CHECK(names.size() == 6, where, ", column 7: expected 6 columns, got ", names.size());
}

float parse_number(const std::string& where, const char* column, const std::string& field) {
  char* end = nullptr;
  const double value = std::strtod(field.c_str(), &end);
  LTE_CHECK(!field.empty() && end != field.c_str() && *end == '\0', where, ", column ", column,
            ": expected a number, got \"", field, "\"");
  LTE_CHECK(std::isfinite(static_cast<float>(value)), where, ", column ", column, ": ", field,
            " is not a finite float32");
  return static_cast<float>(value);
}

/// Copies point i of `estimate` to point `at` of the result.
void store(const pathtrace::Irradiance& estimate, int64_t i, int64_t rays, size_t at,
           ProbeResult* result) {
  const Rgb& variance = estimate.variance_total[static_cast<size_t>(i)];
  result->total[at] = estimate.total(i);
  result->direct[at] = estimate.direct_sum(i);
  result->standard_error[at] = {std::sqrt(variance.x), std::sqrt(variance.y),
                                std::sqrt(variance.z)};
  result->rays[at] = rays;
}

void probe_fixed(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                 const ProbePoints& points, const ProbeOptions& options, ProbeResult* result) {
  pathtrace::IrradianceOptions tracing;
  tracing.rays = static_cast<int>(options.rays);
  tracing.max_depth = options.max_depth;
  tracing.seed = hash_combine(options.seed, 2);
  const size_t N = points.position.size();
  Progress progress("probing", static_cast<int64_t>(N), "points");
  for (size_t first = 0; first < N; first += kBlock) {
    const size_t count = std::min(kBlock, N - first);
    const auto block = pathtrace::estimate_irradiance(
        bvh, lights, std::span(points.position).subspan(first, count),
        std::span(points.normal).subspan(first, count), tracing, static_cast<int64_t>(first));
    for (size_t i = 0; i < count; ++i)
      store(block, static_cast<int64_t>(i), block.rays, first + i, result);
    progress.advance(static_cast<int64_t>(count));
  }
}

void probe_adaptive(const pathtrace::Bvh& bvh, const pathtrace::Lights& lights,
                    const ProbePoints& points, const ProbeOptions& options, ProbeResult* result) {
  pathtrace::AdaptiveOptions tracing;
  tracing.scale = pathtrace::ErrorScale::OwnTotal;
  tracing.target_error = options.target_error;
  tracing.max_rays = static_cast<int>(std::max<int64_t>(2, options.rays));
  tracing.min_rays = std::min(kPilotRays, tracing.max_rays);
  tracing.max_depth = options.max_depth;
  tracing.seed = options.seed;
  const size_t N = points.position.size();
  Progress progress("probing", 0, "paths");
  const pathtrace::AdaptiveIrradiance estimate =
      pathtrace::estimate_adaptive(bvh, lights, points.position, points.normal, tracing,
                                   [&progress](int64_t paths) { progress.advance(paths); });
  for (size_t i = 0; i < N; ++i)
    store(estimate.irradiance, static_cast<int64_t>(i), estimate.rays[i], i, result);
  result->missed = estimate.missed;
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
      if (line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
      check_header(where, line);
      continue;
    }
    if (trimmed(line).empty()) continue;
    const std::vector<std::string> fields = split(line);
    LTE_CHECK(fields.size() <= 6, where, ", column ", 7, ": expected 6 columns, got ",
              fields.size());
    LTE_CHECK(fields.size() == 6, where, ", column ", kColumns[fields.size()], ": missing");
    float values[6];
    for (size_t c = 0; c < 6; ++c) values[c] = parse_number(where, kColumns[c], fields[c]);
    for (size_t c = 0; c < 3; ++c)
      LTE_CHECK(std::abs(values[c]) <= scene::kMaxCoordinate, where, ", column ", kColumns[c], ": ",
                fields[c], " is farther than ", scene::kMaxCoordinate, " from the origin");
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
  const pathtrace::Bvh bvh(scene);
  const pathtrace::Lights lights(scene);
  if (options.target_error == 0) {
    probe_fixed(bvh, lights, points, options, &result);
  } else {
    probe_adaptive(bvh, lights, points, options, &result);
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
        line += formatted(",%.9g", static_cast<double>(value[c]));
      }
    }
    file.write(concat(line, ",", result.rays[i], "\n"));
  }
  file.commit();
}

}  // namespace lte::datagen
