#include "lte/scene/point_table.h"

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/text.h"
#include "lte/scene/number_check.h"

namespace lte::scene {
namespace {

constexpr const char* kHeader = "px,py,pz,nx,ny,nz";
constexpr const char* kColumns[6] = {"px", "py", "pz", "nx", "ny", "nz"};
/// What spreadsheets put before UTF-8.
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

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

/// With the nine digits that bring a float back, and counts with all that they have.
std::string number(double value) {
  const bool whole = value == std::floor(value) && std::abs(value) < 1e15;
  return whole ? formatted("%.0f", value) : formatted("%.9g", value);
}

}  // namespace

PointTable read_point_table(const std::filesystem::path& path) {
  std::istringstream text(read_file(path));
  PointTable points;
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
      LTE_CHECK(std::abs(values[c]) <= kMaxCoordinate, where, ", column ", kColumns[c], ": ",
                fields[c], " is farther than ", kMaxCoordinate, " from the origin");
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

void write_point_table(const std::filesystem::path& path, const PointTable& points,
                       const PointColumns& columns) {
  AtomicFile file(path);
  std::string header = kHeader;
  for (const std::string& name : columns.names) header += "," + name;
  file.write(header + "\n");
  for (size_t i = 0; i < points.lines.size(); ++i) {
    std::string line = points.lines[i];
    for (const double value : columns.rows[i]) line += "," + number(value);
    file.write(line + "\n");
  }
  file.commit();
}

}  // namespace lte::scene
