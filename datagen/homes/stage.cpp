#include "datagen/homes/stage.h"

#include "lte/base/check.h"

namespace lte::datagen::homes {

Asset Stage::outline(const Piece& piece) {
  return {piece.name, piece.bounds(), piece.solids, piece.tops, piece.by_parts, piece.point_lights,
          {}};
}

Asset Stage::load(Piece&& piece) {
  Asset asset = outline(piece);
  for (auto& [material, mesh] : piece.meshes) {
    mesh.material = material;
    mesh.name = piece.name;
    asset.meshes.push_back(static_cast<int>(scene().meshes.size()));
    scene().meshes.push_back(std::move(mesh));
  }
  return asset;
}

int Stage::add_group(const std::string& name) {
  scene().light_groups.push_back(name);
  return static_cast<int>(scene().light_groups.size()) - 1;
}

void Stage::instance(const Asset& asset, const std::string& name, const Affine& to_world) {
  for (const int mesh : asset.meshes) {
    const int material = scene().meshes[static_cast<size_t>(mesh)].material;
    const bool emits = scene().materials[static_cast<size_t>(material)].emissive();
    scene().instances.push_back({mesh, to_world, emits ? add_group(name) : scene::kNone});
  }
  for (const PointLight& light : asset.point_lights) {
    scene::PunctualLight punctual;
    punctual.name = name;
    punctual.position = to_world.point(light.position);
    punctual.intensity = light.intensity;
    punctual.light_group = add_group(name);
    scene().lights.push_back(punctual);
  }
}

int Stage::place(const Asset& asset, int room, const Affine& to_world, int parent) {
  const auto index = static_cast<int>(plan().pieces.size());
  const std::string name = concat("piece ", index, " ", asset.name);
  instance(asset, name, to_world);
  plan().pieces.push_back(placed(asset, room, to_world, parent));
  return index;
}

void Stage::fill(int placed, Piece&& piece) {
  const Affine to_world = plan().pieces[static_cast<size_t>(placed)].to_world;
  const std::string name = concat("piece ", placed, " ", piece.name);
  instance(load(std::move(piece)), name, to_world);
}

void Stage::build(Piece&& piece) {
  const Asset asset = load(std::move(piece));
  instance(asset, asset.name, {});
}

PlacedPiece placed(const Asset& asset, int room, const Affine& to_world, int parent) {
  PlacedPiece piece{
      asset.name, room, parent, asset.by_parts, to_world, oriented_box(asset.bounds, to_world), {}};
  for (const Bounds& solid : asset.solids) piece.solids.push_back(oriented_box(solid, to_world));
  return piece;
}

}  // namespace lte::datagen::homes
