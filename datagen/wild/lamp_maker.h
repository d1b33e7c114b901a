// One luminaire of a kind in a cell: the forms behind place_lamps().
#pragma once

#include "datagen/wild/lamps.h"

namespace lte::datagen::wild {

class LampMaker {
 public:
  LampMaker(Builder* builder, homes::Kit* kit, Dice* dice)
      : builder_(builder), kit_(kit), dice_(dice), scale_(builder->plan->unit / 4) {}

  /// @return  false if it found no place
  bool place(LampKind kind, int cell);

 private:
  const Cell& cell() const { return builder_->plan->cells[static_cast<size_t>(cell_)]; }
  float height() const { return cell().ceiling.eaves - cell().floor; }
  /// A point at least `margin` from the walls; false if tries run out.
  bool point(float margin, Vec2* p);
  /// An angle about y, along the first wall in most.
  float angle();

  // lamp_forms.cpp: ceilings and free space
  bool flush_panel();
  bool hanging_panel(bool two_sided);
  bool upright_sheet();
  bool globe();
  bool tube();
  bool open_shade();
  bool kit_lamp();
  bool punctual(bool spot);
  // lamp_walls.cpp: walls and windows
  bool screen();
  bool glowing_wall();
  bool cove();
  bool behind_board();
  bool pane();

  struct Stretch {
    size_t edge = 0;
    float u0 = 0, u1 = 0, low = 0, high = 0;  ///< heights over the floor of the cell
  };
  /// A free part of a wall, its size drawn in shares of the whole.
  bool stretch(float least, float most, Stretch* out);

  bool claim(const Bounds& bounds, const Affine& at, float margin);
  /// Adds an emitting mesh of unit luminance to the lamp. @param faces  1 or 2
  void shine(Mesh&& mesh, const Affine& at, int faces);
  void body(Mesh&& mesh, const Affine& at) {
    builder_->add(std::move(mesh), builder_->materials->thing(), at, "lamp");
  }

  Builder* builder_;
  homes::Kit* kit_;
  Dice* dice_;
  float scale_;
  int cell_ = 0;
  Lamp lamp_;
};

float area_of(const Mesh& mesh);

}  // namespace lte::datagen::wild
