// Embeddings on disk: what the encoder made of a scene, to be read in a moment instead of made
// again.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "lte/runtime/embedding.h"

namespace lte::runtime {

/// What an embedding was made of, as its owner says: texts by name, such as {"seed", "0"}. Names
/// are made of letters, digits, blanks and dashes.
using EmbeddingKey = std::map<std::string, std::string>;

/// Writes an embedding as safetensors, atomically, with the fingerprint of its network, the
/// network's precision, and `key`. Emission gains are no part of it: it is saved as at gain 1.
///
/// Metadata: format "lte-embedding", format_version, lte_version, model, precision, scene_points,
/// and each name of the key with "key " before it. Tensors: position [m, 3], features [m, D],
/// origin [3], scale [1], spacing [1] and emission_scale [3] of nn::Embedding; normal [m, 3] where
/// the model reads normals; surfels [M, 21] where it casts rays among the scene points;
/// cache.position, cache.normal [S, 3], cache.light [S, 6] and cache.floor [3] where it reads
/// traced light. The decoder's table is left out, as it is made of the features in no time and ten
/// times as large.
/// @throws lte::Error if the file cannot be written.
void save_embedding(const std::filesystem::path& path, const SceneEmbedding& embedding,
                    const EmbeddingKey& key);

/// Reads an embedding onto the network's device. Its answers are bit for bit those of the one that
/// was saved, with the same threads and device.
/// @throws lte::Error of one line that names the file if it is no embedding, of a newer format or
///         damaged; and if the model, its precision or an entry of the key is another one than it
///         was made with, naming the first that differs and both values.
SceneEmbedding load_embedding(const std::filesystem::path& path, const Network& network,
                              const EmbeddingKey& key, const MemoryLimit& memory = {});

}  // namespace lte::runtime
