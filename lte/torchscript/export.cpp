#include "lte/torchscript/export.h"

#include <cstring>
#include <ostream>

#include <nlohmann/json.hpp>
#include <torch/csrc/jit/api/module.h>
#include <torch/csrc/jit/frontend/resolver.h>
#include <torch/csrc/jit/frontend/sugared_value.h>
#include <torch/csrc/jit/serialization/import.h>

#include "lte/base/check.h"
#include "lte/base/file.h"
#include "lte/base/version.h"
#include "lte/nn/files/model_file.h"
#include "lte/nn/points/synthetic_room.h"
#include "lte/torchscript/network.h"
#include "lte/torchscript/ops.h"
#include "lte/torchscript/silent_file.h"
#include "lte/torchscript/solved_light.h"

namespace lte::torchscript {
namespace {

/// Lets the source say lte.knn(...) for torch.ops.lte.knn, beside torch.cat(...).
struct LteResolver : torch::jit::Resolver {
  std::shared_ptr<torch::jit::SugaredValue> resolveValue(const std::string& name,
                                                         torch::jit::GraphFunction&,
                                                         const torch::jit::SourceRange&) override {
    if (name == "torch") return std::make_shared<torch::jit::BuiltinModule>("aten");
    if (name == "lte") return std::make_shared<torch::jit::BuiltinModule>("lte");
    return nullptr;
  }
};

torch::jit::Module build_module(const nn::LightTransportModel& model, bool portable) {
  torch::jit::Module module("lte_model");
  for (const auto& item : model->named_parameters()) {
    module.register_parameter(attribute_of(item.key()), item.value().detach().clone(),
                              /*is_buffer=*/false);
  }
  const std::string light =
      model->config().solves_light() ? solved_light_source(portable) : std::string();
  module.define(ops_source(portable) + light + network_source(model->config()),
                std::make_shared<LteResolver>());
  module.eval();
  return module;
}

/// Names of the columns that encode() takes; see point_rows().
std::vector<std::string> point_columns(const nn::ModelConfig& config) {
  std::vector<std::string> out = {"position", "normal", "albedo", "emission", "area"};
  if (config.reads_light())
    out.insert(out.end(), {"direct", "indirect", "direct_back", "indirect_back"});
  if (config.reads_estimates()) out.emplace_back("indirect_error");
  if (config.predicts_radiance()) out.emplace_back("gloss");
  return out;
}

std::string normalization_json(const nn::ModelConfig& config) {
  nlohmann::json json{{"scale_m", config.scale},
                      {"points", point_columns(config)},
                      {"queries", {"position", "normal", "albedo"}},
                      {"position",
                       "network space is (p - min over scene points) / scale_m; encode() and "
                       "decode() do it"},
                      {"irradiance",
                       "W/m^2 of light that bounced at least once, linear Rec.709, not divided by "
                       "pi"}};
  if (config.solves_light())
    json["solved"] = {"direct", "indirect", "direct_back", "indirect_back"};
  if (config.predicts_radiance()) json["radiance"] = "W sr^-1 m^-2, linear Rec.709";
  return json.dump(1) + "\n";
}

/// The columns encode() takes.
at::Tensor point_rows(const nn::PointSet& points, const nn::ModelConfig& config) {
  std::vector<at::Tensor> columns = {points.position, points.normal, points.albedo, points.emission,
                                     points.area.unsqueeze(1)};
  if (config.reads_light())
    columns.insert(columns.end(),
                   {points.direct, points.indirect, points.direct_back, points.indirect_back});
  if (config.reads_estimates()) columns.push_back(points.indirect_error);
  if (config.predicts_radiance()) columns.push_back(points.gloss);
  return at::cat(columns, 1);
}

/// The room, of which every fourth point is of metal, from a mirror's to quite rough.
nn::PointSet room_with_metal(int64_t scene_points) {
  nn::PointSet points = nn::synthetic_room(scene_points, 11);
  const at::Tensor number = at::arange(scene_points);
  points.gloss = at::stack(
      {number.remainder(4).eq(0).to(at::kFloat), number.remainder(7).to(at::kFloat).div(8)}, 1);
  return points;
}

/// So many directions of each query, above its surface.
at::Tensor directions_above(const nn::QuerySet& queries, int64_t count) {
  const at::Tensor turn = at::arange(3 * count * queries.normal.size(0), at::kFloat).sin();
  const at::Tensor way = queries.normal.unsqueeze(1) + 0.5 * turn.view({-1, count, 3});
  return way.div(way.norm(2, {2}, true));
}

/// Queries of which radiance is compared, and directions of each.
constexpr int64_t kAskedForRadiance = 1000, kDirections = 2;

ExportCheck compare(torch::jit::Module& module, nn::LightTransportModel& model,
                    int64_t scene_points, int64_t queries) {
  const nn::PointSet points = room_with_metal(scene_points);
  const nn::PointSet surface = nn::synthetic_room(queries, 12);
  const at::Tensor rows = at::cat({surface.position, surface.normal, surface.albedo}, 1);
  const nn::Embedding native = model->encode(nn::in_canonical_order(points));
  const at::Tensor expected =
      model->decode(native, {surface.position, surface.normal, surface.albedo});
  const c10::IValue embedding = module.get_method("encode")({point_rows(points, model->config())});
  const at::Tensor got = module.get_method("decode")({embedding, rows}).toTensor();
  const double largest = expected.abs().max().item<double>();
  ExportCheck check{scene_points, queries,
                    (got - expected).abs().max().item<double>() / std::max(largest, 1e-30)};
  if (!model->config().predicts_radiance()) return check;
  const auto some = [](const at::Tensor& of) { return of.slice(0, 0, kAskedForRadiance); };
  const nn::QuerySet points_seen{some(surface.position), some(surface.normal),
                                 some(surface.albedo)};
  const at::Tensor ways = directions_above(points_seen, kDirections);
  const at::Tensor radiance = model->decode_radiance(native, points_seen, ways);
  const at::Tensor answer = module.get_method("radiance")({embedding, some(rows), ways}).toTensor();
  check.radiance_error = (answer - radiance).abs().mean().item<double>() /
                         std::max(radiance.abs().mean().item<double>(), 1e-30);
  return check;
}

/// @param to    the temporary that stands for `path`, which messages name
void save_archive(const torch::jit::Module& module, const torch::jit::ExtraFilesMap& extra,
                  const std::filesystem::path& path, const std::filesystem::path& to) {
  SilentFile file(to);
  std::ostream stream(&file);
  module.save(stream, extra);
  const int error = file.close();
  LTE_CHECK(error == 0, path.string(), ": cannot write: ", std::strerror(error));
}

}  // namespace

std::vector<ExportCheck> export_torchscript(const ExportOptions& options) {
  const at::NoGradGuard no_grad;
  const auto say = [&](const std::string& step) {
    if (options.progress) options.progress(step);
  };
  say(concat("reading ", options.model.string()));
  nn::LightTransportModel model = nn::load_model(options.model);
  say("compiling the module");
  const torch::jit::Module module = build_module(model, options.portable);
  const torch::jit::ExtraFilesMap extra{{"config.yaml", model->config().to_yaml()},
                                        {"normalization.json", normalization_json(model->config())},
                                        {"version.txt", version()}};
  AtomicFile file(options.out);
  say(concat("writing ", options.out.string()));
  save_archive(module, extra, options.out, file.temporary_path());
  std::vector<ExportCheck> checks;
  if (!options.verify.empty()) {
    say("reading it again");
    torch::jit::Module loaded = torch::jit::load(file.temporary_path().string());
    loaded.eval();
    for (const auto& [scene_points, queries] : options.verify) {
      say(concat("comparing at ", scene_points, " scene points and ", queries, " queries"));
      checks.push_back(compare(loaded, model, scene_points, queries));
      LTE_CHECK(checks.back().relative_error <= 1e-4, options.out.string(), ": with ", scene_points,
                " scene points the exported module deviates from the native model by ",
                checks.back().relative_error, " of the largest value; nothing was written");
      LTE_CHECK(checks.back().radiance_error <= 1e-3, options.out.string(), ": with ", scene_points,
                " scene points the radiance of the exported module deviates by ",
                checks.back().radiance_error, " of its mean; nothing was written");
    }
  }
  file.commit();
  return checks;
}

void export_rounded(const std::filesystem::path& model, const std::filesystem::path& out) {
  nn::save_rounded(model, out);
}

}  // namespace lte::torchscript
