// lte_eval incident: error of incident radiance by direction (incident_eval.h).
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "infer/eval/eval_command.h"

namespace lte::infer {

struct IncidentRequest {
  std::string traced;
};

/// Adds the subcommand; it has been chosen if app.got_subcommand() says so. Model, data and split
/// are those of lte_eval itself.
CLI::App* add_incident_command(CLI::App& app, IncidentRequest* request);

/// Evaluates, prints a table, and writes --json.
/// @throws lte::Error for bad input, CLI::ValidationError for flags that are missing.
void run_incident(const IncidentRequest& request, const EvalRequest& eval);

}  // namespace lte::infer
