// --embedding and --save-embedding: a scene's embedding kept from one run to the next.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "infer/common/renderer.h"
#include "lte/cli/command_files.h"
#include "lte/runtime/embedding_file.h"

namespace lte::infer {

struct EmbeddingFlags {
  std::string load, save;  ///< files; empty: none

  bool any() const { return !load.empty() || !save.empty(); }
};

/// Adds both flags, which exclude each other.
void add_embedding_flags(CLI::App& app, EmbeddingFlags* flags);

void claim_embedding(const EmbeddingFlags& flags, CommandFiles* files);

/// Everything but network and precision that an embedding of Renderer::embed() depends on: the
/// fingerprint of the scene, and how its points are drawn.
runtime::EmbeddingKey embedding_key(const scene::Scene& scene, const runtime::Network& network,
                                    const EmbedSettings& settings);

/// Reads the renderer's embedding from the file of --embedding, or makes it by embed() and writes
/// it to that of --save-embedding.
/// @throws lte::Error as Renderer::embed() and runtime::load_embedding()
void provide_embedding(const EmbeddingFlags& flags, const runtime::Network& network,
                       const EmbedSettings& settings, Renderer* renderer);

}  // namespace lte::infer
