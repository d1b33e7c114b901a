// What the commands that compute a scene's light share on their command lines: the integrator, and
// what its network and its irradiance cache are made of.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "infer/renderer/embedding_flags.h"
#include "infer/renderer/renderer.h"
#include "infer/tool/tool_options.h"
#include "lte/cli/scene_source.h"
#include "lte/cli/set_keys.h"

namespace lte::infer {

/// The command line as it stands. The flags themselves check its words.
struct LightRequest : SceneSource {
  std::string integrator = "gather", checkpoint;
  std::optional<runtime::Network> network;  ///< of `checkpoint`, where it is loaded already
  int max_depth = 5;
  int64_t records = render::CacheSettings().records;
  uint64_t seed = 0;
  bool validate_only = false;
  EmbeddingFlags embedding;
  ToolOptions tool;
  SetKeys keys;
  CLI::App* flags = nullptr;  ///< that it was read from

  bool by_paths() const { return integrator == "path"; }
  bool needs_network() const { return integrator == "network"; }
};

/// Adds --integrator, --checkpoint and --seed.
/// @param from  where rays begin: "each pixel"
void add_light_flags(CLI::App& app, const std::string& from, LightRequest* request);
/// Adds the keys depth and records.
/// @param start  what comes before the surface hits that count: "the texel"
void add_light_keys(const std::string& start, LightRequest* request);
/// Adds the keys of scene, embedding and network, --set for all of them, and the flags of scene
/// and tool.
void add_tool_flags(CLI::App& app, LightRequest* request);

/// Whatever of those is given has an effect.
/// @param gather_keys  that go with gather and network alone
/// @throws lte::Error of one line for what would be ignored
void check_light_used(const LightRequest& request, std::initializer_list<const char*> gather_keys);

/// Notes the files that those flags name.
void claim_light_files(const LightRequest& request, CommandFiles* files);

/// Settings of a cache, but for its seed.
render::CacheSettings cache_settings(const LightRequest& request);

/// The network of the request.
/// @throws runtime::LimitError where the scene is wider than it knows
runtime::Network load_network(const LightRequest& request, const scene::Scene& scene);

/// The scene as the network reads it. Warns of light in it that the network does not know.
/// @param receivers  where light is asked for
EmbedSettings embed_settings(const LightRequest& request, const runtime::Network& network,
                             const embed::Receivers& receivers, const Renderer& renderer);

/// The first of these flags that stands on the command line; null if none does.
const char* first_given(const CLI::App& app, std::initializer_list<const char*> flags);
const char* first_set(const SetKeys& keys, std::initializer_list<const char*> names);

}  // namespace lte::infer
