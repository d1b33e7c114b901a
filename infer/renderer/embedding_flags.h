// A scene's embedding as command lines have it: what it is made of (keys scene_points, prune and
// rescale), and a file that keeps it from one run to the next (--embedding, --save-embedding).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "infer/renderer/renderer.h"
#include "lte/cli/command_files.h"
#include "lte/cli/set_keys.h"
#include "lte/embed/embed.h"
#include "lte/runtime/embedding_file.h"

namespace lte::infer {

struct EmbeddingFlags {
  int64_t scene_points = 0;  ///< 0: as many as the scene needs
  std::string prune = "auto";
  bool rescale = true;
  std::string load, save;  ///< files; empty: none

  bool has_file() const { return !load.empty() || !save.empty(); }
};

/// Adds the flags, which exclude each other.
void add_embedding_flags(CLI::App& app, EmbeddingFlags* flags);
/// Adds the keys.
void add_embedding_keys(SetKeys* keys, EmbeddingFlags* flags);

void claim_embedding(const EmbeddingFlags& flags, CommandFiles* files);

EmbedSettings embed_settings(const EmbeddingFlags& flags, uint64_t seed,
                             const runtime::MemoryLimit& memory);

/// culled_lights() of an embedding of these flags: nothing where a file has it, as that answers
/// whatever another command asks.
std::vector<int> culled_lights(const EmbeddingFlags& flags, const pathtrace::Bvh& bvh,
                               const runtime::Network& network, const EmbedSettings& settings,
                               const embed::Receivers& receivers);

/// Has the settings leave that light out, and says so in a line.
/// @return  seconds that it was looked for
double cull_lights(const EmbeddingFlags& flags, const pathtrace::Bvh& bvh,
                   const runtime::Network& network, const embed::Receivers& receivers,
                   EmbedSettings* settings);

/// Whether the network has seen in training all kinds of light that it would read. A line says so
/// where not: paths then trace the light of records in its place.
bool knows_light(const EmbeddingFlags& flags, const pathtrace::Bvh& bvh,
                 const runtime::Network& network, const EmbedSettings& settings,
                 const embed::Receivers& receivers);

/// Reads the renderer's embedding from the file of --embedding, or makes it by embed() and writes
/// it to that of --save-embedding.
/// @throws lte::Error as Renderer::embed() and runtime::load_embedding()
void provide_embedding(const EmbeddingFlags& flags, const runtime::Network& network,
                       const EmbedSettings& settings, Renderer* renderer);

}  // namespace lte::infer
