// What a result on disk was made of, so that a run that goes on with an earlier one makes no
// mixture.
#pragma once

#include <map>
#include <set>
#include <string>

#include <CLI/CLI.hpp>

#include "lte/runtime/network.h"
#include "lte/scene/scene.h"

namespace lte::infer {

/// Flags as the command line shows them, and fingerprints, by name.
using MadeWith = std::map<std::string, std::string>;

/// The flags of `app` that change a result of a given scene and network, with the fingerprints of
/// scene and, where there is one, network. A flag that is new counts.
/// @param no_matter  flags of this tool that change nothing, beside those of all tools
MadeWith made_with(CLI::App& app, const scene::Scene& scene, const runtime::Network* network,
                   const std::set<std::string>& no_matter);

/// @param what  "the frames were"
/// @param hint  what to do, after the difference
/// @throws lte::Error naming the file and the first difference
void check_made_with(const std::string& file, const std::string& what, const MadeWith& there,
                     const MadeWith& here, const std::string& hint);

}  // namespace lte::infer
