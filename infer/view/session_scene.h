// A session as pages see it: lists of lights, materials and objects, and edits of them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "infer/session/edit.h"
#include "infer/session/session.h"
#include "infer/view/messages.h"
#include "infer/view/scene_description.h"

namespace lte::infer::view {

/// The objects of a file. Instances that follow one another under the same transform, other than
/// none, are one object, as exporters write the parts of a chair.
/// @param first  the state of a session before any edit
std::vector<ObjectDescription> list_objects(const SessionState& first);

/// Instances that were added together, as an object.
ObjectDescription describe_object(const SessionState& state, const std::vector<int>& instances,
                                  const std::string& name);

/// Lists a scene: of these objects those that are in it.
SceneDescription describe_scene(const SessionState& state,
                                const std::vector<ObjectDescription>& objects);

/// What every light, material and object is set to, in the order of the description.
std::vector<PageEdit> settings_of(const SessionState& state, const SceneDescription& scene);

/// The session's edits for those of a page.
/// @throws lte::Error if the scene has no such light, material or object.
std::vector<infer::Edit> session_edits(std::span<const PageEdit> edits,
                                       const SceneDescription& scene);

/// The same for what a page adds or removes: a CopyObject, RemoveObject, AddLamp or RemoveLamp.
std::vector<infer::Edit> session_edits(const Request& request, const SessionState& state,
                                       const SceneDescription& scene);

Picked pick(const SessionState& state, const SceneDescription& scene, const scene::Camera& camera,
            float aspect, float x, float y);

EditCost cost_of(const EditReport& report);

}  // namespace lte::infer::view
