#include "infer/eval/scenes/figures_json.h"

#include <array>
#include <limits>
#include <utility>

#include "lte/base/json_number.h"

namespace lte::infer {
namespace {

constexpr std::array<std::pair<const char*, double PairError::*>, 8> kNumbers = {
    {{"mean", &PairError::mean},
     {"mean_ratio", &PairError::mean_ratio},
     {"mse", &PairError::mse},
     {"mse_stderr", &PairError::mse_stderr},
     {"block_error", &PairError::block_error},
     {"path_variance", &PairError::path_variance},
     {"worth", &PairError::worth},
     {"cap", &PairError::cap}}};

nlohmann::json error_json(const PairError& error) {
  nlohmann::json out{{"pixels", error.pixels}, {"below_noise", error.below_noise}};
  for (const auto& [name, member] : kNumbers) out[name] = json_number(error.*member);
  return out;
}

double number_of(const nlohmann::json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

PairError error_of(const nlohmann::json& json) {
  PairError out;
  out.pixels = json.at("pixels");
  out.below_noise = json.at("below_noise");
  for (const auto& [name, member] : kNumbers) out.*member = number_of(json.at(name));
  return out;
}

}  // namespace

nlohmann::json figures_json(const MethodFigures& figures) {
  nlohmann::json whole = error_json(figures.whole);
  whole["flip"] = json_number(figures.flip);
  whole["ssim"] = json_number(figures.ssim);
  return {{"irradiance", error_json(figures.irradiance)},
          {"whole", whole},
          {"right", figures.irradiance.is_right()},
          {"seconds", json_number(figures.seconds.wall)},
          {"processor_seconds", json_number(figures.seconds.processor)}};
}

MethodFigures figures_of(const nlohmann::json& json) {
  MethodFigures out;
  out.irradiance = error_of(json.at("irradiance"));
  out.whole = error_of(json.at("whole"));
  out.flip = number_of(json.at("whole").at("flip"));
  out.ssim = number_of(json.at("whole").at("ssim"));
  out.seconds = {number_of(json.at("seconds")), number_of(json.at("processor_seconds"))};
  return out;
}

}  // namespace lte::infer
