// The balance heuristic of multiple importance sampling (Veach and Guibas 1995), by which light
// samples and sampled directions share the light that both can find.
#pragma once

namespace lte::pathtrace {

/// Weight of a sample that was drawn with density `pdf`, and that another technique draws with
/// `other`.
inline float balance_heuristic(float pdf, float other) { return pdf / (pdf + other); }

/// What a light sample's contribution is divided by: the weight over the density, 1 / (light_pdf +
/// direction_pdf), is one over this.
/// @param light_pdf      as LightBlock::pdf: negative where no direction finds the light
/// @param direction_pdf  density with which directions are sampled there
inline float balance_density(float light_pdf, float direction_pdf) {
  return light_pdf < 0 ? -light_pdf : light_pdf + direction_pdf;
}

}  // namespace lte::pathtrace
