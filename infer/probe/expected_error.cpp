#include "infer/probe/expected_error.h"

#include <cmath>

namespace lte::infer {
namespace {

struct SharesOfModel {
  ErrorTerms one_draw, several_draws;
};

/// lte-base.
constexpr SharesOfModel kRadiosity = {.one_draw = {.mean = 0.017,
                                                   .answer = 0.018,
                                                   .near = 0.32,
                                                   .change = 0.63,
                                                   .cache = 0.077,
                                                   .direct = 0.013},
                                      .several_draws = {.draws = 0.82,
                                                        .mean = 0.013,
                                                        .answer = 0.012,
                                                        .near = 0.27,
                                                        .change = 0.47,
                                                        .cache = 0.077,
                                                        .direct = 0.011}};
/// lte-hybrid.
constexpr SharesOfModel kTraced = {
    .one_draw = {.mean = 0.014,
                 .answer = 0.018,
                 .near = 0.23,
                 .change = 0.65,
                 .cache = 0.24,
                 .direct = 0.012},
    .several_draws = {
        .draws = 1, .mean = 0.01, .answer = 0.0094, .near = 0.18, .change = 0.4, .cache = 0.29}};
/// lte-demo.
constexpr SharesOfModel kEmission = {
    .one_draw = {.answer = 0.19, .near = 0.73, .change = 4.7, .direct = 0.12},
    .several_draws = {.draws = 2.4, .answer = 0.15, .near = 0.66, .change = 4.4, .direct = 0.11}};

}  // namespace

const ErrorTerms& error_shares(nn::LightInput input, bool several) {
  const SharesOfModel& shares = input == nn::LightInput::Radiosity ? kRadiosity
                                : input == nn::LightInput::Traced  ? kTraced
                                                                   : kEmission;
  return several ? shares.several_draws : shares.one_draw;
}

double expected_error(const ErrorTerms& terms, const ErrorTerms& shares) {
  const auto term = terms.values(), share = shares.values();
  double squares = 0;
  for (size_t i = 0; i < term.size(); ++i) squares += std::pow(share[i] * term[i], 2);
  return std::sqrt(squares);
}

}  // namespace lte::infer
