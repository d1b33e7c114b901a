// Fewer rows of a baked scene: scene points drawn from more, and query points that nobody asks
// about left out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lte/base/random.h"
#include "lte/data/scene_sample.h"

namespace lte::data {

/// Draws `count` distinct rows of [0, rows), ascending; all of them if count is 0 or not below
/// rows. Each row is as likely as any other. The rows are cut into `count` runs of equal length to
/// within one row, from a random start, and one row comes from each: so tables that are sorted in
/// space are covered evenly.
std::vector<int64_t> draw_rows(int64_t rows, int64_t count, Rng* rng);

/// Draws the scene points that are kept of a scene with more than `count`, ascending. It calls
/// draw_rows() within each light group and within the rest, for each in proportion and for at least
/// one point, so that no luminaire is lost. There are `count`, unless there are more groups: a
/// point too many can cost the network a whole attention patch.
/// @param light  [M], SceneSample::scene_light
std::vector<int64_t> draw_scene_rows(std::span<const int32_t> light, int64_t count, Rng* rng);

/// Areas of the kept points, scaled so that each light group, and the rest, keeps its whole area:
/// the emission scalar must not jump with the draw.
/// @param light, area  [M], of all points
/// @return [rows], m²
std::vector<float> kept_areas(std::span<const int32_t> light, std::span<const float> area,
                              std::span<const int64_t> rows);

/// Keeps `count` scene points as draw_scene_rows() draws them from the sample's own seed, the same
/// ones each time; all of them if count is 0 or not below their number.
void thin_scene_points(SceneSample* sample, int64_t count);

/// Removes the query points that no picture asks about. First, those that no traced path has
/// connected to a light (direct and indirect irradiance exactly zero in every group): the insides
/// of closed furniture and the like, one point in ten of a furnished room. Second, those on
/// surfaces that reflect nothing, which the renderer leaves out too; the pixels that show such
/// surfaces leave the views' masks. A relative loss would spend most of its gradient on telling the
/// zero of the first from a small number; the second, panes behind a sunlit blind among them, can
/// be brighter than all else. A sample of which no point would stay keeps them all.
/// @return  how many points were removed
int64_t drop_idle_queries(SceneSample* sample);

}  // namespace lte::data
