// Internal to lte_bench bake: what else could bake a light map.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/bake_measured.h"

namespace lte::bench {

/// Plain paths at every texel; as they are, as means over neighbours in the world, and denoised by
/// Open Image Denoise in the atlas, where that library is found.
/// @param rounds  of means
void add_paths(const MeasuredScene& m, int paths, int rounds, uint64_t seed,
               std::vector<BakeRow>* rows);

/// The network's own answer at every texel.
void add_network(const std::string& checkpoint, uint64_t seed, MeasuredScene* m,
                 std::vector<BakeRow>* rows);

/// Blender's Cycles, by scripts/validation/cycles_light_map.py.
/// @param python  that has bpy
/// @throws lte::Error if the script fails, which says why on standard error
void add_cycles(const MeasuredScene& m, const std::string& python, int samples, uint64_t seed,
                std::vector<BakeRow>* rows);

}  // namespace lte::bench
