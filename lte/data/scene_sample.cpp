#include "lte/data/scene_sample.h"

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/safetensors.h"
#include "lte/data/sample_check.h"

namespace lte::data {
namespace {

constexpr const char* kFormat = "lte-scene";
constexpr int64_t kMaxViews = 4096;

static_assert(sizeof(Vec3) == 3 * sizeof(float), "Vec3 arrays are stored as [., 3] float32");

void add(SafetensorsWriter* writer, const std::string& name, std::vector<int64_t> shape,
         const std::vector<Vec3>& v) {
  shape.push_back(3);
  writer->add(name, std::move(shape), reinterpret_cast<const float*>(v.data()));
}

void read(const SafetensorsFile& file, const std::string& name, std::vector<int64_t> shape,
          std::vector<Vec3>* out) {
  shape.push_back(3);
  const auto values = file.values<float>(name, shape);
  out->resize(values.size() / 3);
  for (size_t i = 0; i < out->size(); ++i)
    (*out)[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

template <typename T>
void read(const SafetensorsFile& file, const std::string& name, const std::vector<int64_t>& shape,
          std::vector<T>* out) {
  const auto values = file.values<T>(name, shape);
  out->assign(values.begin(), values.end());
}

std::string few_paths_name(const std::string& prefix, size_t i) {
  return concat(prefix, "path_traced_", kFewPaths[i]);
}

std::string view_prefix(size_t k) { return concat("view", k, "_"); }

void add_view(SafetensorsWriter* writer, size_t k, int64_t groups, const View& view) {
  const std::string prefix = view_prefix(k);
  const std::vector<int64_t> plane{view.height, view.width};
  const std::vector<int64_t> stack{groups, view.height, view.width};
  add(writer, prefix + "position", plane, view.position);
  add(writer, prefix + "normal", plane, view.normal);
  add(writer, prefix + "albedo", plane, view.albedo);
  add(writer, prefix + "direct", stack, view.direct);
  add(writer, prefix + "indirect", stack, view.indirect);
  writer->add(prefix + "mask", plane, view.mask.data());
  writer->add(prefix + "variance", plane, view.variance.data());
  if (!view.path_traced_64.empty())
    add(writer, prefix + "path_traced_64", plane, view.path_traced_64);
  for (size_t i = 0; i < kFewPaths.size(); ++i) {
    if (!view.path_traced_few[i].empty())
      add(writer, few_paths_name(prefix, i), plane, view.path_traced_few[i]);
  }
}

View read_view(const SafetensorsFile& file, size_t k, int64_t groups) {
  const std::string prefix = view_prefix(k);
  View view;
  const TensorView& mask = file.at(prefix + "mask");
  LTE_CHECK(mask.shape.size() == 2 && mask.shape[0] >= 1 && mask.shape[1] >= 1 &&
                mask.shape[0] <= 1 << 16 && mask.shape[1] <= 1 << 16,
            file.path().string(), ": tensor ", prefix,
            "mask: expected a shape [height, width] of 1 to 65536 each");
  view.height = static_cast<int>(mask.shape[0]);
  view.width = static_cast<int>(mask.shape[1]);
  const std::vector<int64_t> plane{view.height, view.width};
  const std::vector<int64_t> stack{groups, view.height, view.width};
  read(file, prefix + "mask", plane, &view.mask);
  read(file, prefix + "position", plane, &view.position);
  read(file, prefix + "normal", plane, &view.normal);
  read(file, prefix + "albedo", plane, &view.albedo);
  read(file, prefix + "direct", stack, &view.direct);
  read(file, prefix + "indirect", stack, &view.indirect);
  read(file, prefix + "variance", plane, &view.variance);
  if (file.contains(prefix + "path_traced_64"))
    read(file, prefix + "path_traced_64", plane, &view.path_traced_64);
  for (size_t i = 0; i < kFewPaths.size(); ++i) {
    if (file.contains(few_paths_name(prefix, i)))
      read(file, few_paths_name(prefix, i), plane, &view.path_traced_few[i]);
  }
  return view;
}

/// A metadata value, which safetensors keeps as text, as the integer it stands for.
uint64_t metadata_integer(const SafetensorsFile& file, const std::string& key) {
  const std::string& text = file.metadata(key);
  const bool digits = !text.empty() && text.size() <= 20 &&
                      text.find_first_not_of("0123456789") == std::string::npos;
  LTE_CHECK(digits, file.path().string(), ": metadata ", key,
            ": expected a non-negative integer, got \"", text, "\"");
  try {
    return std::stoull(text);
  } catch (const std::out_of_range&) {
    throw Error(
        concat(file.path().string(), ": metadata ", key, ": ", text, " does not fit 64 bits"));
  }
}

/// A metadata value that files may lack: 0 then.
double optional_number(const SafetensorsFile& file, const std::string& key) {
  const auto found = file.metadata().find(key);
  if (found == file.metadata().end()) return 0;
  const auto json = nlohmann::json::parse(found->second, nullptr, false);
  LTE_CHECK(json.is_number() && json.get<double>() >= 0, file.path().string(), ": metadata ", key,
            ": expected a number that is not negative, got \"", found->second, "\"");
  return json.get<double>();
}

void read_bounds(const SafetensorsFile& file, SceneSample* sample) {
  const std::string& text = file.metadata("bounds");
  const auto json = nlohmann::json::parse(text, nullptr, false);
  bool good = json.is_array() && json.size() == 6;
  for (size_t i = 0; good && i < 6; ++i) good = json[i].is_number();
  LTE_CHECK(good, file.path().string(),
            ": metadata bounds: expected [low x, y, z, high x, y, z], got \"", text, "\"");
  for (size_t i = 0; i < 6; ++i)
    (i < 3 ? sample->bounds_low : sample->bounds_high)[static_cast<int>(i % 3)] =
        json[i].get<float>();
}

void check_header(const SafetensorsFile& file) {
  const auto format = file.metadata().find("format");
  LTE_CHECK(format != file.metadata().end() && format->second == kFormat, file.path().string(),
            ": not a scene sample: metadata format is ",
            format == file.metadata().end() ? std::string("missing") : '"' + format->second + '"',
            ", expected \"", kFormat, "\"");
  const uint64_t version = metadata_integer(file, "version");
  LTE_CHECK(version >= 1 && version <= static_cast<uint64_t>(kSceneSampleVersion),
            file.path().string(), ": version ", version,
            " is not supported; this build reads up to version ", kSceneSampleVersion,
            ": update lte");
}

}  // namespace

void write_scene_sample(const std::filesystem::path& path, const SceneSample& sample) {
  check_sample(path.string(), sample);
  const int64_t M = sample.scene_points(), N = sample.query_points(), G = sample.light_groups;
  SafetensorsWriter writer;
  writer.set_metadata("format", kFormat);
  writer.set_metadata("version", std::to_string(kSceneSampleVersion));
  writer.set_metadata("name", sample.name);
  writer.set_metadata("seed", std::to_string(sample.seed));
  writer.set_metadata("rays", std::to_string(sample.rays));
  if (sample.target_error > 0)
    writer.set_metadata("target_error", nlohmann::json(sample.target_error).dump());
  if (sample.pruned_scene_points > 0)
    writer.set_metadata("pruned_scene_points", std::to_string(sample.pruned_scene_points));
  if (sample.pruned_query_points > 0)
    writer.set_metadata("pruned_query_points", std::to_string(sample.pruned_query_points));
  writer.set_metadata("max_depth", std::to_string(sample.max_depth));
  writer.set_metadata("views", std::to_string(sample.views.size()));
  const Vec3 &low = sample.bounds_low, &high = sample.bounds_high;
  writer.set_metadata("bounds", nlohmann::json{low.x, low.y, low.z, high.x, high.y, high.z}.dump());
  add(&writer, "scene_position", {M}, sample.scene_position);
  add(&writer, "scene_normal", {M}, sample.scene_normal);
  add(&writer, "scene_albedo", {M}, sample.scene_albedo);
  add(&writer, "scene_emission", {M}, sample.scene_emission);
  writer.add("scene_area", {M}, sample.scene_area.data());
  writer.add("scene_light", {M}, sample.scene_light.data());
  if (!sample.scene_direct.empty()) {
    add(&writer, "scene_direct", {G, M}, sample.scene_direct);
    add(&writer, "scene_indirect", {G, M}, sample.scene_indirect);
  }
  if (!sample.scene_metallic.empty()) {
    writer.add("scene_metallic", {M}, sample.scene_metallic.data());
    writer.add("scene_roughness", {M}, sample.scene_roughness.data());
  }
  add(&writer, "query_position", {N}, sample.query_position);
  add(&writer, "query_normal", {N}, sample.query_normal);
  add(&writer, "query_albedo", {N}, sample.query_albedo);
  add(&writer, "direct", {G, N}, sample.direct);
  add(&writer, "indirect", {G, N}, sample.indirect);
  writer.add("variance", {N}, sample.variance.data());
  if (!sample.query_rays.empty()) writer.add("query_rays", {N}, sample.query_rays.data());
  if (!sample.path_traced_64.empty()) add(&writer, "path_traced_64", {N}, sample.path_traced_64);
  for (size_t k = 0; k < sample.views.size(); ++k) add_view(&writer, k, G, sample.views[k]);
  if (!sample.incident.empty()) add_incident(&writer, G, sample.incident);
  writer.write(path);
}

SceneSample read_scene_sample(const std::filesystem::path& path) {
  const SafetensorsFile file(path);
  check_header(file);
  SceneSample sample;
  sample.name = file.metadata("name");
  sample.seed = metadata_integer(file, "seed");
  const uint64_t rays = metadata_integer(file, "rays"),
                 max_depth = metadata_integer(file, "max_depth");
  LTE_CHECK(rays <= uint64_t{1} << 40 && max_depth >= 1 && max_depth <= 1 << 20, path.string(),
            ": metadata rays ", rays, " or max_depth ", max_depth, " is out of range");
  sample.rays = static_cast<int64_t>(rays);
  sample.max_depth = static_cast<int>(max_depth);
  sample.target_error = optional_number(file, "target_error");
  for (const auto& [key, count] : {std::pair{"pruned_scene_points", &sample.pruned_scene_points},
                                   std::pair{"pruned_query_points", &sample.pruned_query_points}}) {
    if (file.metadata().contains(key)) *count = static_cast<int64_t>(metadata_integer(file, key));
  }
  read_bounds(file, &sample);

  read(file, "scene_position", {-1}, &sample.scene_position);
  read(file, "query_position", {-1}, &sample.query_position);
  const int64_t M = sample.scene_points(), N = sample.query_points();
  const TensorView& direct = file.at("direct");
  LTE_CHECK(direct.shape.size() == 3, path.string(), ": tensor direct: expected a shape [groups, ",
            N, ", 3]");
  const int64_t G = sample.light_groups = direct.shape[0];
  read(file, "scene_normal", {M}, &sample.scene_normal);
  read(file, "scene_albedo", {M}, &sample.scene_albedo);
  read(file, "scene_emission", {M}, &sample.scene_emission);
  read(file, "scene_area", {M}, &sample.scene_area);
  read(file, "scene_light", {M}, &sample.scene_light);
  if (file.contains("scene_direct")) {
    read(file, "scene_direct", {G, M}, &sample.scene_direct);
    read(file, "scene_indirect", {G, M}, &sample.scene_indirect);
  }
  if (file.contains("scene_metallic")) {
    read(file, "scene_metallic", {M}, &sample.scene_metallic);
    read(file, "scene_roughness", {M}, &sample.scene_roughness);
  }
  read(file, "query_normal", {N}, &sample.query_normal);
  read(file, "query_albedo", {N}, &sample.query_albedo);
  read(file, "direct", {G, N}, &sample.direct);
  read(file, "indirect", {G, N}, &sample.indirect);
  read(file, "variance", {N}, &sample.variance);
  if (file.contains("query_rays")) read(file, "query_rays", {N}, &sample.query_rays);
  if (file.contains("path_traced_64")) read(file, "path_traced_64", {N}, &sample.path_traced_64);
  const uint64_t views = metadata_integer(file, "views");
  LTE_CHECK(views <= kMaxViews, path.string(), ": metadata views: ", views, " is above the cap of ",
            kMaxViews);
  for (size_t k = 0; k < views; ++k) sample.views.push_back(read_view(file, k, G));
  sample.incident = read_incident(file, G);
  check_sample(path.string(), sample);
  return sample;
}

int64_t drop_idle_queries(SceneSample* sample) {
  for (View& view : sample->views) {
    for (size_t i = 0; i < view.mask.size(); ++i) {
      if (max_component(view.albedo[i]) <= 0) view.mask[i] = 0;
    }
  }
  const auto N = static_cast<size_t>(sample->query_points());
  const auto G = static_cast<size_t>(sample->light_groups);
  std::vector<size_t> kept;
  for (size_t i = 0; i < N; ++i) {
    bool reached = false;
    for (size_t g = 0; g < G && !reached; ++g) {
      reached = max_component(sample->direct[g * N + i]) > 0 ||
                max_component(sample->indirect[g * N + i]) > 0;
    }
    if (reached && max_component(sample->query_albedo[i]) > 0) kept.push_back(i);
  }
  if (kept.empty() || kept.size() == N) return 0;
  const auto compact = [&](auto& values, size_t rows) {
    if (values.empty()) return;
    for (size_t row = 0; row < rows; ++row) {
      for (size_t k = 0; k < kept.size(); ++k)
        values[row * kept.size() + k] = values[row * N + kept[k]];
    }
    values.resize(rows * kept.size());
  };
  for (auto* triples : {&sample->query_position, &sample->query_normal, &sample->query_albedo,
                        &sample->path_traced_64}) {
    compact(*triples, 1);
  }
  compact(sample->direct, G);
  compact(sample->indirect, G);
  compact(sample->variance, 1);
  compact(sample->query_rays, 1);
  return static_cast<int64_t>(N - kept.size());
}

}  // namespace lte::data
