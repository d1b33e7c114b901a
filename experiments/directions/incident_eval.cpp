#include "experiments/directions/incident_eval.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <ATen/ATen.h>
#include <nlohmann/json.hpp>

#include "infer/eval/measure/embed_sample.h"
#include "lte/base/check.h"
#include "lte/base/text.h"
#include "lte/cli/progress.h"
#include "lte/data/scene_sample.h"
#include "lte/nn/model.h"
#include "lte/runtime/torch_parts.h"

namespace lte::experiments {

using namespace infer;

namespace {

/// π L over the scene's mean emission, [cells, points, 3] float64, of light that bounced at least
/// once.
at::Tensor reference_maps(const data::SceneSample& sample, double emission) {
  const data::IncidentField& field = sample.incident;
  const int64_t P = field.points(), cells = static_cast<int64_t>(field.direction.size());
  at::Tensor out = at::zeros({P, cells, 3}, at::kDouble);
  auto* values = out.data_ptr<double>();
  const int64_t count = P * cells * 3;
  for (int64_t i = 0; i < sample.light_groups * count; ++i) {
    const auto at = static_cast<size_t>(i);
    const double scale = field.scale[static_cast<size_t>(i % count / (cells * 3))];
    values[i % count] += std::numbers::pi / emission * scale * to_float(field.indirect[at]);
  }
  return out.transpose(0, 1).contiguous();
}

/// World directions of the cells, those of one point after those of another.
std::vector<Vec3> world_directions(const data::IncidentField& field) {
  std::vector<Vec3> out;
  for (size_t p = 0; p < field.position.size(); ++p) {
    const Vec3 normal = field.normal[p], tangent = field.tangent[p];
    for (const Vec3& d : field.direction)
      out.push_back(tangent * d.x + cross(normal, tangent) * d.y + normal * d.z);
  }
  return out;
}

/// The same form of what is said of each point and direction, in W sr⁻¹ m⁻².
at::Tensor maps_of(const std::vector<Rgb>& radiance, int64_t points, double emission) {
  const auto all = static_cast<int64_t>(radiance.size());
  return at::from_blob(const_cast<Rgb*>(radiance.data()), {points, all / points, 3},
                       at::TensorOptions(at::kFloat))
      .to(at::kDouble)
      .mul(std::numbers::pi / emission)
      .transpose(0, 1)
      .contiguous();
}

data::SceneSample read_incident(const std::filesystem::path& folder, const std::string& name) {
  const std::filesystem::path path = data::scene_path(folder, name);
  data::SceneSample sample = data::read_scene_sample(path);
  LTE_CHECK(!sample.incident.empty(), path.string(),
            ": has no incident radiance; bake it with incident.points");
  return sample;
}

/// What rays see of the scene points, in the form of reference_maps(); `even` where they meet none.
at::Tensor seen_maps(const runtime::SceneEmbedding& embedding, const data::IncidentField& field,
                     const std::vector<Vec3>& directions, const at::Tensor& even) {
  const nn::Embedding parts = runtime::TorchParts::embedding(embedding);
  const auto tensor = [](const std::vector<Vec3>& of) {
    return at::from_blob(const_cast<Vec3*>(of.data()), {static_cast<int64_t>(of.size()), 3},
                         at::TensorOptions(at::kFloat));
  };
  const at::Tensor place = (tensor(field.position) - parts.origin.cpu()) / parts.scale;
  const at::Tensor seen =
      parts.surfels.see(place, tensor(directions).view({field.points(), -1, 3})).to(at::kDouble);
  const at::Tensor unit = parts.emission_scale.to(at::kDouble) / embedding.mean_emission();
  const at::Tensor light = (seen.narrow(2, nn::kSeenRadiance, 3) * unit).transpose(0, 1);
  const at::Tensor hit = seen.select(2, nn::kSeenHit).transpose(0, 1).unsqueeze(2) > 0;
  return at::where(hit, light, even);
}

/// Adds the errors of the model's answers, by direction and as irradiance.
/// @param row  gets the maps at the first point; null: nobody
void add_network(const data::SceneSample& sample, const runtime::SceneEmbedding& embedding,
                 const at::Tensor& reference, double share, IncidentResult* result, MapRow* row) {
  const data::IncidentField& field = sample.incident;
  const double emission = embedding.mean_emission();
  const runtime::QueryPoints queries{field.position, field.normal, field.albedo};
  const std::vector<Vec3> directions = world_directions(field);
  const std::vector<Rgb> answers = embedding.decode_radiance(queries, directions);
  const at::Tensor neural = maps_of(answers, field.points(), emission);
  result->neural.add(errors_of(neural, reference), share);
  std::vector<Rgb> uniform = embedding.decode(queries);
  for (Rgb& value : uniform) value *= 1 / kPi;
  const at::Tensor even = maps_of(uniform, field.points(), emission).expand_as(reference);
  result->even.add(errors_of(even, reference), share);
  if (row != nullptr) row->maps.emplace_back("network", first_of(neural));
  const at::Tensor seen = seen_maps(embedding, field, directions, even);
  result->seen.add(errors_of(seen, reference), share);
  if (row != nullptr) row->maps.emplace_back("seen of the points", first_of(seen));
}

void add_traced(const IncidentSettings& settings, const data::SceneSample& sample,
                const at::Tensor& reference, double emission, double share, IncidentResult* result,
                MapRow* row) {
  const data::SceneSample rival = read_incident(settings.traced, sample.name);
  const at::Tensor maps = reference_maps(rival, emission);
  const bool same = maps.sizes() == reference.sizes() &&
                    std::equal(rival.incident.position.begin(), rival.incident.position.end(),
                               sample.incident.position.begin());
  LTE_CHECK(same, data::scene_path(settings.traced, sample.name).string(),
            ": has other points or directions than the scene of that name in ",
            settings.data.string());
  result->traced.add(errors_of(maps, reference), share);
  result->traced_paths = static_cast<double>(rival.incident.samples);
  if (row != nullptr)
    row->maps.emplace_back(concat("traced, ", result->traced_paths, " paths"), first_of(maps));
}

nlohmann::json to_json(const MapErrors& errors) {
  return {{"logrel", errors.logrel}, {"log_mse", errors.log_mse}, {"mse", errors.mse}};
}

std::string row(const std::string& name, const MapErrors& errors) {
  return formatted("  %-34s %10.4f %10.4f %12.5f\n", name.c_str(), errors.logrel, errors.log_mse,
                   errors.mse);
}

}  // namespace

IncidentResult evaluate_incident(const IncidentSettings& settings,
                                 const runtime::Network& network) {
  LTE_CHECK(network.config().predicts_radiance(),
            "the model has no radiance decoder (its model.radiance_lobes is 0)");
  const std::vector<data::DatasetEntry> entries =
      data::entries_of(data::read_dataset_info(settings.data), settings.split);
  LTE_CHECK(!entries.empty(), settings.data.string(), ": no scene is in the split \"",
            data::split_name(settings.split), "\"");
  IncidentResult result;
  std::optional<HarmonicBaselines> harmonics;
  std::optional<GaussianBaselines> gaussians;
  const double share = 1 / static_cast<double>(entries.size());
  lte::Progress progress("evaluating", static_cast<int64_t>(entries.size()), "scenes");
  for (const data::DatasetEntry& entry : entries) {
    data::SceneSample sample = read_incident(settings.data, entry.name);
    thin_for(network, settings.scene_points, &sample);
    const runtime::SceneEmbedding embedding = embed_sample(sample, network, settings.memory);
    const double emission = embedding.mean_emission();
    const at::Tensor reference = reference_maps(sample, emission);
    if (!harmonics) {
      result.cells = reference.size(0);
      harmonics.emplace(sample.incident, settings.highest_degree, &result.harmonics);
      gaussians.emplace(sample.incident, settings.lobes, &result.gaussians);
    }
    LTE_CHECK(reference.size(0) == result.cells, entry.name, ": has ", reference.size(0),
              " directions a point, and the scenes before it ", result.cells);
    MapRow row{concat(entry.name, " 0"), {{"reference", first_of(reference)}}};
    MapRow* shown = result.pictures.size() < kMapRows ? &row : nullptr;
    add_network(sample, embedding, reference, share, &result, shown);
    if (!settings.traced.empty())
      add_traced(settings, sample, reference, emission, share, &result, shown);
    harmonics->add_scene(reference, share, shown);
    gaussians->add_scene(reference, share, shown);
    if (shown != nullptr) result.pictures.push_back(row);
    ++result.scenes;
    result.points += sample.incident.points();
    progress.advance();
  }
  return result;
}

std::string incident_table(const IncidentResult& result) {
  std::string text = formatted(
      "%lld scenes, %lld points, %lld directions each\n", static_cast<long long>(result.scenes),
      static_cast<long long>(result.points), static_cast<long long>(result.cells));
  text += formatted("  %-34s %10s %10s %12s\n", "", "logrel", "log_mse", "mse");
  text += row("neural", result.neural);
  text += row("seen of the points", result.seen);
  text += row("even (the model's irradiance)", result.even);
  if (result.traced_paths > 0)
    text += row(formatted("traced, %.0f paths a direction", result.traced_paths), result.traced);
  for (const HarmonicErrors& h : result.harmonics) {
    if (h.degree % 2 == 1 && h.degree > 3) continue;  // all are in the JSON
    text += row(formatted("harmonics, l <= %d, ", h.degree) + enum_name(h.fit), h.errors);
  }
  for (const GaussianErrors& g : result.gaussians)
    text += row(formatted("gaussians, %d, ", g.lobes) + enum_name(g.fit), g.errors);
  return text;
}

std::string incident_json(const IncidentResult& result, const std::string& model,
                          const std::string& data) {
  nlohmann::json json = {{"model", model},
                         {"data", data},
                         {"scenes", result.scenes},
                         {"points", result.points},
                         {"cells", result.cells},
                         {"neural", to_json(result.neural)},
                         {"even", to_json(result.even)}};
  json["seen"] = to_json(result.seen);
  if (result.traced_paths > 0) {
    json["traced"] = to_json(result.traced);
    json["traced"]["paths"] = result.traced_paths;
  }
  for (const HarmonicErrors& h : result.harmonics) {
    nlohmann::json entry = to_json(h.errors);
    entry["degree"] = h.degree;
    entry["coefficients"] = (h.degree + 1) * (h.degree + 1);
    entry["numbers"] = h.numbers();
    entry["negative"] = h.negative;
    json["harmonics"][enum_name(h.fit)].push_back(entry);
  }
  for (const GaussianErrors& g : result.gaussians) {
    nlohmann::json entry = to_json(g.errors);
    entry["lobes"] = g.lobes;
    entry["numbers"] = g.numbers();
    json["gaussians"][enum_name(g.fit)].push_back(entry);
  }
  return json.dump(2) + "\n";
}

}  // namespace lte::experiments
