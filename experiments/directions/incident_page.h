// The page of lte_eval incident: error by the degree of the harmonics and by the numbers that a map
// takes, and maps beside one another.
#pragma once

#include <string>

#include "experiments/directions/incident_eval.h"

namespace lte::experiments {

/// @param model, data  what was compared, for the reader
std::string incident_html(const IncidentResult& result, const std::string& model,
                          const std::string& data);

}  // namespace lte::experiments
