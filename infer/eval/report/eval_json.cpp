#include <nlohmann/json.hpp>

#include "infer/eval/report/eval_report.h"
#include "lte/base/json_number.h"
#include "lte/base/process_memory.h"

namespace lte::infer {
namespace {

using Json = nlohmann::json;

/// Makes {"points": {metric: value(&Score::points, k)}, "views": {..}} for every metric k.
template <typename Value>
Json by_metric(const Value& value) {
  Json out;
  for (size_t k = 0; k < kPointMetrics.size(); ++k)
    out["points"][kPointMetrics[k]] = value(&Score::points, k);
  for (size_t k = 0; k < kViewMetrics.size(); ++k)
    out["views"][kViewMetrics[k]] = value(&Score::views, k);
  return out;
}

Json to_json(const Scores& scores) {
  Json out = Json::object();
  for (const auto& entry : scores) {
    const Score& score = entry.second;
    out[entry.first] =
        by_metric([&](auto member, size_t metric) { return json_number((score.*member)[metric]); });
  }
  return out;
}

Json to_json(const ScoreIntervals& intervals) {
  Json out = Json::object();
  for (const auto& entry : intervals) {
    const ScoreInterval& bounds = entry.second;
    out[entry.first] = by_metric([&](auto member, size_t metric) {
      return Json(
          {json_number((bounds.low.*member)[metric]), json_number((bounds.high.*member)[metric])});
    });
  }
  return out;
}

Json to_json(const EqualSamples& samples) {
  return {{"all", json_number(samples.all)},
          {"interval", {json_number(samples.interval.low), json_number(samples.interval.high)}},
          {"median", json_number(samples.median)}};
}

Json scene_json(const EvalResult& result, size_t index) {
  const SceneResult& scene = result.scenes[index];
  Json samples = Json::object();
  for (const PredictorSamples& predictor : result.equal_samples) {
    samples[predictor.name] = {{"points", json_number(predictor.points.scenes[index])},
                               {"views", json_number(predictor.views.scenes[index])}};
  }
  return {{"name", scene.name},
          {"emission_scalar", scene.radiance},
          {"reference_noise_mse", json_number(scene.reference_noise)},
          {"views_noise_mse", json_number(scene.views_noise)},
          {"points", scene.points},
          {"views", scene.views},
          {"encode_seconds", scene.encode_seconds},
          {"decode_seconds", scene.decode_seconds},
          {"metrics", to_json(scene.scores)},
          {"equal_samples", samples}};
}

}  // namespace

std::string eval_json(const EvalResult& result, const std::string& checkpoint,
                      const std::string& data) {
  Json scenes = Json::array();
  double encode = 0, decode = 0;
  for (size_t i = 0; i < result.scenes.size(); ++i) {
    scenes.push_back(scene_json(result, i));
    encode += result.scenes[i].encode_seconds;
    decode += result.scenes[i].decode_seconds;
  }
  Json samples = Json::object();
  for (const PredictorSamples& predictor : result.equal_samples) {
    samples[predictor.name] = {{"points", to_json(predictor.points)},
                               {"views", to_json(predictor.views)}};
  }
  const Json json = {{"split", result.split},
                     {"scenes", result.scenes.size()},
                     {"checkpoint", checkpoint},
                     {"data", data},
                     {"metrics", to_json(result.mean)},
                     {"median", to_json(result.median)},
                     {"confidence",
                      {{"level", result.bootstrap.level},
                       {"resamples", result.bootstrap.resamples},
                       {"seed", result.bootstrap.seed},
                       {"metrics", to_json(result.mean_interval)},
                       {"median", to_json(result.median_interval)}}},
                     {"equal_samples", samples},
                     {"variance_check",
                      {{"ratio", json_number(result.variance_check.ratio)},
                       {"exponent", json_number(result.variance_check.exponent)}}},
                     {"per_scene", scenes},
                     {"seconds", {{"encode", encode}, {"decode", decode}}},
                     {"peak_rss_mb", peak_rss_mb()}};
  return json.dump(2) + '\n';
}

}  // namespace lte::infer
