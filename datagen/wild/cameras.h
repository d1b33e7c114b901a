// Cameras in the cells of a finished scene, and whether what they see is fit to learn from.
#pragma once

#include <string>
#include <vector>

#include "datagen/wild/dice.h"
#include "datagen/wild/plan.h"
#include "lte/pathtrace/bvh.h"
#include "lte/scene/scene.h"

namespace lte::datagen::wild {

/// One camera a cell that has room for one, the largest cell first.
/// @param to_world  from the plan to the scene, of a rotation about y and a scale
std::vector<scene::Camera> place_cameras(const Plan& plan, const Affine& to_world,
                                         const pathtrace::Bvh& bvh, Dice* dice);

/// Traces a few paths: drops cameras that see no light.
/// @return  why the scene is to be drawn again, or nothing
std::string check_scene(const pathtrace::Bvh& bvh, uint64_t seed, scene::Scene* scene);

}  // namespace lte::datagen::wild
