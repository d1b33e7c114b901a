#include "lte/data/scene_sample.h"

#include <nlohmann/json.hpp>

#include "lte/base/check.h"
#include "lte/base/safetensors.h"
#include "lte/data/sample_check.h"

namespace lte::data {
namespace {

constexpr const char* kFormat = "lte-scene";
constexpr const char* kIncidentSamples = "incident_samples";
constexpr size_t kMaxViews = 4096;
constexpr int64_t kMaxViewSize = 1 << 16;
constexpr int64_t kMaxBins = 1024;

/// Visits tensors and adds them to a file; optional ones if they are there.
struct TensorWriter {
  SafetensorsWriter* writer;

  template <typename T>
  void operator()(const TensorRule& rule, const std::vector<T>& values) const {
    if (rule.optional() && values.empty()) return;
    writer->add(rule.name, file_shape<T>(rule),
                reinterpret_cast<const ScalarOf<T>*>(values.data()));
  }
};

/// Visits tensors and fills them from a file.
struct TensorReader {
  const SafetensorsFile& file;

  template <typename T>
  void operator()(const TensorRule& rule, std::vector<T>& out) const {
    if (rule.optional() && !file.contains(rule.with)) return;
    const auto scalars = file.values<ScalarOf<T>>(rule.name, file_shape<T>(rule));
    const auto* const first = reinterpret_cast<const T*>(scalars.data());
    out.assign(first, first + scalars.size_bytes() / sizeof(T));
  }
};

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

/// Entries of a tensor [., 3] float32.
size_t count_vectors(const SafetensorsFile& file, const std::string& name) {
  return file.values<float>(name, {-1, 3}).size() / 3;
}

void read_view_size(const SafetensorsFile& file, size_t k, View* view) {
  const std::string name = concat("view", k, "_mask");
  const std::vector<int64_t>& shape = file.at(name).shape;
  LTE_CHECK(shape.size() == 2 && shape[0] >= 1 && shape[1] >= 1 && shape[0] <= kMaxViewSize &&
                shape[1] <= kMaxViewSize,
            file.path().string(), ": tensor ", name, ": expected a shape [height, width] of 1 to ",
            kMaxViewSize, " each");
  view->height = static_cast<int>(shape[0]);
  view->width = static_cast<int>(shape[1]);
}

/// Leaves the field empty if the file has none.
void read_incident_size(const SafetensorsFile& file, IncidentField* field) {
  const auto found = file.metadata().find(kIncidentSamples);
  if (found == file.metadata().end()) return;
  const std::string& text = found->second;
  LTE_CHECK(!text.empty() && text.size() <= 9 &&
                text.find_first_not_of("0123456789") == std::string::npos,
            file.path().string(), ": metadata ", kIncidentSamples,
            ": expected a non-negative integer below 10^9, got \"", text, "\"");
  field->samples = std::stoll(text);
  const std::vector<int64_t>& shape = file.at("incident_pdf").shape;
  LTE_CHECK(shape.size() == 2 && shape[0] == shape[1] && shape[0] >= 2 && shape[0] <= kMaxBins &&
                shape[0] % 2 == 0,
            file.path().string(),
            ": tensor incident_pdf: expected a shape [bins, bins], even, of 2 to ", kMaxBins);
  field->bins = static_cast<int>(shape[0]);
  field->position.resize(count_vectors(file, "incident_position"));
}

/// What the shapes of all tensors follow from.
void read_sizes(const SafetensorsFile& file, SceneSample* sample) {
  sample->scene_position.resize(count_vectors(file, "scene_position"));
  sample->query_position.resize(count_vectors(file, "query_position"));
  const std::vector<int64_t>& direct = file.at("direct").shape;
  LTE_CHECK(direct.size() == 3, file.path().string(), ": tensor direct: expected a shape [groups, ",
            sample->query_points(), ", 3]");
  sample->light_groups = direct[0];
  const uint64_t views = metadata_integer(file, "views");
  LTE_CHECK(views <= kMaxViews, file.path().string(), ": metadata views: ", views,
            " is above the cap of ", kMaxViews);
  sample->views.resize(views);
  for (size_t k = 0; k < views; ++k) read_view_size(file, k, &sample->views[k]);
  read_incident_size(file, &sample->incident);
}

void read_metadata(const SafetensorsFile& file, SceneSample* sample) {
  sample->name = file.metadata("name");
  if (file.metadata().contains("geometry")) sample->geometry = file.metadata("geometry");
  sample->seed = metadata_integer(file, "seed");
  const uint64_t rays = metadata_integer(file, "rays"),
                 max_depth = metadata_integer(file, "max_depth");
  LTE_CHECK(rays <= uint64_t{1} << 40 && max_depth >= 1 && max_depth <= 1 << 20,
            file.path().string(), ": metadata rays ", rays, " or max_depth ", max_depth,
            " is out of range");
  sample->rays = static_cast<int64_t>(rays);
  sample->max_depth = static_cast<int>(max_depth);
  sample->target_error = optional_number(file, "target_error");
  for (const auto& [key, count] :
       {std::pair{"pruned_scene_points", &sample->pruned_scene_points},
        std::pair{"pruned_query_points", &sample->pruned_query_points}}) {
    if (file.metadata().contains(key)) *count = static_cast<int64_t>(metadata_integer(file, key));
  }
  read_bounds(file, sample);
}

void write_metadata(const SceneSample& sample, SafetensorsWriter* writer) {
  writer->set_metadata("format", kFormat);
  writer->set_metadata("version", std::to_string(kSceneSampleVersion));
  writer->set_metadata("name", sample.name);
  if (!sample.geometry.empty()) writer->set_metadata("geometry", sample.geometry);
  writer->set_metadata("seed", std::to_string(sample.seed));
  writer->set_metadata("rays", std::to_string(sample.rays));
  if (sample.target_error > 0)
    writer->set_metadata("target_error", nlohmann::json(sample.target_error).dump());
  if (sample.pruned_scene_points > 0)
    writer->set_metadata("pruned_scene_points", std::to_string(sample.pruned_scene_points));
  if (sample.pruned_query_points > 0)
    writer->set_metadata("pruned_query_points", std::to_string(sample.pruned_query_points));
  writer->set_metadata("max_depth", std::to_string(sample.max_depth));
  writer->set_metadata("views", std::to_string(sample.views.size()));
  const Vec3 &low = sample.bounds_low, &high = sample.bounds_high;
  writer->set_metadata("bounds",
                       nlohmann::json{low.x, low.y, low.z, high.x, high.y, high.z}.dump());
  if (!sample.incident.empty())
    writer->set_metadata(kIncidentSamples, std::to_string(sample.incident.samples));
}

}  // namespace

void write_scene_sample(const std::filesystem::path& path, const SceneSample& sample) {
  check_sample(path.string(), sample);
  SafetensorsWriter writer;
  write_metadata(sample, &writer);
  for_each_tensor(sample, TensorWriter{&writer});
  writer.write(path);
}

SceneSample read_scene_sample(const std::filesystem::path& path) {
  const SafetensorsFile file(path);
  check_header(file);
  file.verify();
  SceneSample sample;
  read_metadata(file, &sample);
  read_sizes(file, &sample);
  for_each_tensor(sample, TensorReader{file});
  check_sample(path.string(), sample);
  return sample;
}

}  // namespace lte::data
