// What each type of room has. The most important pieces come first, since later ones are left out
// where no room is left.
#include <algorithm>

#include "datagen/common/parts.h"
#include "datagen/homes/furnish.h"

namespace lte::datagen::homes {

void Furnisher::bedroom() {
  const Rect& r = placer_.inner();
  bool two = std::min(r.width(), r.depth()) > 2.8f && kit_->chance(0.8f);
  std::optional<int> bed;
  Bounds bed_box;
  for (int attempt = 0; attempt < 3 && !bed; ++attempt, two = false) {  // at last a single bed
    Piece piece = make_bed(kit_, two);
    bed_box = piece.bounds();
    bed = put(std::move(piece), [&](const Asset& a) {
      PlaceOptions options;
      options.front = 0.45f;
      if (const auto index =
              placer_.against_wall(a, sides_without(OpeningKind::Doorway), true, options))
        return index;
      return placer_.against_wall(a, placer_.all_sides(), attempt > 0, {});
    });
  }
  if (bed) {
    const Affine at = placer_.where(*bed);
    for (const float side : {-1.0f, 1.0f}) {
      Piece table = make_bedside(kit_);
      const std::vector<Bounds> tops = table.tops;
      const Bounds b = table.bounds();
      const float x = side * (bed_box.high.x + 0.06f + b.extent().x / 2);
      const Affine beside = at * translation({x, 0, bed_box.low.z - b.low.z});
      const auto index =
          put(std::move(table), [&](const Asset& a) { return placer_.try_at(a, beside, {}); });
      if (!index) continue;
      if (kit_->chance(0.8f)) stand(*index, tops[0], Thing::Lamp, true);
      dress(*index, tops, {Thing::Books, Thing::Cup, Thing::Clock, Thing::Candle}, 0.5f);
    }
    const auto [side, along] = wall_of(*bed);
    const float w = kit_->draw(0.6f, 1.0f);
    put_on_wall(make_picture(kit_, w, 0.6f * w), side, along, 1.35f);
  }
  put_at_wall(make_wardrobe(kit_), 0.5f);
  if (kit_->chance(0.7f)) {
    Piece dresser = make_dresser(kit_);
    const std::vector<Bounds> tops = dresser.tops;
    if (const auto index = put_at_wall(std::move(dresser), 0.45f)) {
      const auto [side, along] = wall_of(*index);
      if (kit_->chance(0.6f))
        put_on_wall(make_mirror(kit_, kit_->draw(0.5f, 0.7f), kit_->draw(0.6f, 0.85f)), side, along,
                    tops[0].low.y + 0.25f);
      dress(*index, tops,
            {Thing::Lamp, Thing::Vase, Thing::Books, Thing::Bottle, Thing::Candle, Thing::Bowl});
    }
  }
  if (bed && kit_->chance(0.7f)) {
    const float side = kit_->chance(0.5f) ? 1.0f : -1.0f;
    const Affine beside =
        placer_.where(*bed) * placement(90, {side * (bed_box.high.x + 0.5f), 0, 0.3f});
    rug(beside, kit_->draw(1.2f, 1.6f), kit_->draw(0.7f, 0.85f));
  }
  if (kit_->chance(0.35f)) reading_corner();
  plants(1);
  pictures(2);
}

void Furnisher::living_room() {
  const Rect& r = placer_.inner();
  PlaceOptions front;
  front.front = 0.5f;
  const int seats = std::max(r.width(), r.depth()) > 4 ? kit_->count(2, 3) : 2;
  std::optional<int> sofa;
  Bounds sofa_box;
  for (int attempt = 0; attempt < 3 && !sofa; ++attempt) {
    Piece piece = make_sofa(kit_, attempt == 0 ? seats : 2);
    sofa_box = piece.bounds();
    sofa = put(std::move(piece), [&](const Asset& a) {
      return placer_.against_wall(a, sides_without(OpeningKind::Doorway), true,
                                  attempt < 2 ? front : PlaceOptions{});
    });
  }
  if (sofa) {
    const Affine at = placer_.where(*sofa);
    const auto [side, along] = wall_of(*sofa);
    const Side across_room = opposite(side);
    const float along_wall = along;  // Clang 14 captures no structured bindings.
    put(make_media_bench(kit_), [&](const Asset& a) -> std::optional<int> {
      if (const auto index = placer_.try_at(a, placer_.at_wall(a, across_room, along_wall), {}))
        return index;
      return placer_.against_wall(a, {across_room}, true, {});
    });
    const float across = along_z(side) ? r.width() : r.depth();
    const float deep = std::clamp(across - 2.1f, 0.9f, 1.7f);
    const Affine middle = at * translation({0, 0, sofa_box.high.z + 0.08f + deep / 2});
    const float high = kit_->chance(0.85f)
                           ? rug(middle, sofa_box.extent().x * kit_->draw(0.85f, 1.05f), deep)
                           : 0.0f;
    Piece table = make_coffee_table(kit_);
    const std::vector<Bounds> tops = table.tops;
    const float reach = sofa_box.high.z + 0.36f + table.bounds().extent().z / 2;
    // The sofa's own free front is there for the table.
    PlaceOptions nests;
    nests.nests = true;
    const auto index = put(std::move(table), [&](const Asset& a) {
      return placer_.try_at(a, at * translation({0, high, reach}), nests);
    });
    if (index)
      dress(*index, tops,
            {Thing::Books, Thing::Cup, Thing::Fruit, Thing::Candle, Thing::Vase, Thing::Plant,
             Thing::Bowl});
    for (const float end : {-1.0f, 1.0f}) {
      if (!kit_->chance(0.6f)) continue;
      const bool stands = kit_->chance(0.5f);
      Piece piece = stands ? make_floor_lamp(kit_) : make_side_table(kit_);
      const std::vector<Bounds> side_tops = piece.tops;
      const Affine beside =
          at * translation({end * (sofa_box.high.x + 0.06f + piece.bounds().extent().x / 2), 0,
                            sofa_box.low.z + 0.3f});
      const auto put_there =
          put(std::move(piece), [&](const Asset& a) { return placer_.try_at(a, beside, {}); });
      if (put_there && !stands && stand(*put_there, side_tops[0], Thing::Lamp, true))
        dress(*put_there, side_tops, {Thing::Cup, Thing::Books}, 0.4f);
    }
    const float w = kit_->draw(0.7f, 1.2f);
    put_on_wall(make_picture(kit_, w, kit_->draw(0.55f, 0.75f) * w), side, along, 1.15f);
  }
  reading_corner();
  for (int i = kit_->count(1, 2); i > 0; --i) shelf();
  if (r.area() > 20 && kit_->chance(0.5f)) dining_set(kit_->draw(1.2f, 1.6f), 0.85f, false);
  if (kit_->chance(0.4f)) put_in_corner(make_floor_lamp(kit_));
  plants(2);
  pictures(3);
}

void Furnisher::kitchen() {
  const Rect& r = placer_.inner();
  std::vector<Side> sides = sides_without(OpeningKind::Doorway);
  std::stable_sort(sides.begin(), sides.end(), [&](Side a, Side b) {
    const auto score = [&](Side s) {
      return (along_z(s) ? r.depth() : r.width()) -
             (placer_.has_opening(s, OpeningKind::Doorway) ? 2.0f : 0.0f);
    };
    return score(a) > score(b);
  });
  std::optional<int> run;
  for (const float share : {1.0f, 0.85f, 0.7f}) {
    for (const Side side : sides) {
      if (run) break;
      const float wall = along_z(side) ? r.depth() : r.width();
      const float length = std::min(4.4f, share * wall - 0.08f);
      if (length < 1.9f) continue;
      const bool upper = !placer_.has_opening(side, OpeningKind::Window);
      Piece piece = make_kitchen_run(kit_, length, upper);
      const std::vector<Bounds> tops = piece.tops;
      PlaceOptions options;
      options.front = 0.7f;
      run = put(std::move(piece),
                [&](const Asset& a) { return placer_.against_wall(a, {side}, false, options); });
      if (run)
        dress(*run, tops,
              {Thing::Bottle, Thing::Pot, Thing::Cup, Thing::Bowl, Thing::Fruit, Thing::Plate,
               Thing::Soap, Thing::Plant});
    }
  }
  if (!put_in_corner(make_fridge(kit_))) put_at_wall(make_fridge(kit_), 0.5f);
  if (r.area() > 8) dining_set(kit_->draw(0.8f, 1.2f), 0.8f, false);
  if (kit_->chance(0.5f)) {
    Piece dresser = make_dresser(kit_);
    const std::vector<Bounds> tops = dresser.tops;
    if (const auto index = put_at_wall(std::move(dresser), 0.45f))
      dress(*index, tops, {Thing::Bowl, Thing::Fruit, Thing::Bottle, Thing::Plate, Thing::Pot});
  }
  plants(1);
  pictures(1);
}

void Furnisher::bathroom() {
  PlaceOptions front;
  front.front = 0.5f;
  put(make_tub(kit_), [&](const Asset& a) -> std::optional<int> {
    if (const auto index = placer_.in_corner(a, front)) return index;
    return placer_.against_wall(a, placer_.all_sides(), false, {});
  });
  Piece vanity = make_vanity(kit_);
  const std::vector<Bounds> tops = vanity.tops;
  const float width = vanity.bounds().extent().x;
  const auto basin = put(std::move(vanity), [&](const Asset& a) -> std::optional<int> {
    if (const auto index = placer_.against_wall(a, sides_without(OpeningKind::Window), true, front))
      return index;
    return placer_.against_wall(a, placer_.all_sides(), false, {});
  });
  if (basin) {
    dress(*basin, tops, {Thing::Soap, Thing::Cup, Thing::Candle, Thing::Plant, Thing::Bottle});
    const auto [side, along] = wall_of(*basin);
    const float w = width * kit_->draw(0.7f, 0.95f);
    put_on_wall(make_mirror(kit_, w, 0.75f), side, along, 1.1f);
    put_on_wall(make_strip(kit_, 0.6f * w), side, along, 1.92f);
  }
  put_at_wall(make_toilet(kit_), 0.45f);
  const auto rail =
      put(make_towel_rail(kit_), [&](const Asset& a) { return placer_.on_wall(a, 1.25f, {}); });
  if (!rail || kit_->chance(0.4f))
    put(make_towel_rail(kit_), [&](const Asset& a) { return placer_.on_wall(a, 1.25f, {}); });
  Piece mat = make_rug(kit_, kit_->draw(0.7f, 0.9f), kit_->draw(0.45f, 0.55f));
  PlaceOptions flat;
  flat.flat = true;
  put(std::move(mat), [&](const Asset& a) { return placer_.anywhere(a, 0.7f, flat); });
  if (kit_->chance(0.5f)) put_in_corner(make_plant(kit_, kit_->draw(0.5f, 0.9f)));
  if (kit_->chance(0.4f)) put_in_corner(make_stool(kit_));
  pictures(1);
}

void Furnisher::study() {
  Piece desk = make_desk(kit_);
  const std::vector<Bounds> tops = desk.tops;
  const Bounds box = desk.bounds();
  PlaceOptions front;
  front.front = 0.6f;
  const auto index = put(std::move(desk), [&](const Asset& a) {
    return placer_.against_wall(a, placer_.all_sides(), true, front);
  });
  if (index) {
    PlaceOptions nests;
    nests.nests = true;
    const Affine seat = placer_.where(*index) *
                        placement(180 + kit_->draw(-25, 25), {-0.2f, 0, box.high.z + 0.22f});
    put(make_desk_chair(kit_), [&](const Asset& a) { return placer_.try_at(a, seat, nests); });
    stand(*index, tops[0], kit_->chance(0.6f) ? Thing::Monitor : Thing::Laptop, true);
    stand(*index, tops[0], Thing::Lamp, false);
    dress(*index, tops, {Thing::Books, Thing::Cup, Thing::Books, Thing::Plant, Thing::Clock}, 0.7f);
  }
  for (int i = kit_->count(1, 3); i > 0; --i) shelf();
  reading_corner();
  const Rect& r = placer_.inner();
  Piece mat = make_rug(kit_, std::min(1.8f, 0.5f * r.width()), std::min(1.5f, 0.4f * r.depth()));
  PlaceOptions flat;
  flat.flat = true;
  put(std::move(mat), [&](const Asset& a) { return placer_.anywhere(a, 0.5f, flat); });
  plants(2);
  pictures(3);
}

void Furnisher::dining_room() {
  const Rect& r = placer_.inner();
  const float longest = std::max(r.width(), r.depth());
  const float width = std::clamp(longest - 2.4f, 1.2f, kit_->draw(1.4f, 2.2f));
  if (!dining_set(width, kit_->draw(0.85f, 1.0f), kit_->chance(0.6f)) &&
      !dining_set(1.2f, 0.8f, false))
    dining_set(0.85f, 0.85f, false);
  for (int i = kit_->count(1, 2); i > 0; --i) {
    Piece dresser = make_dresser(kit_);
    const std::vector<Bounds> tops = dresser.tops;
    const auto index = put_at_wall(std::move(dresser), 0.3f, true);
    if (!index) continue;
    dress(*index, tops,
          {Thing::Vase, Thing::Lamp, Thing::Bottle, Thing::Fruit, Thing::Candle, Thing::Plate,
           Thing::Bowl});
    const auto [side, along] = wall_of(*index);
    const float w = kit_->draw(0.6f, 0.9f);
    put_on_wall(make_picture(kit_, w, 0.75f * w), side, along, 1.4f);
  }
  if (kit_->chance(0.4f)) shelf();
  plants(2);
  pictures(3);
}

void Furnisher::corridor() {
  for (int i = kit_->count(1, 2); i > 0; --i) {
    Piece console = make_console(kit_);
    const std::vector<Bounds> tops = console.tops;
    const auto index = put_at_wall(std::move(console), 0);
    if (!index) continue;
    dress(*index, tops, {Thing::Vase, Thing::Lamp, Thing::Bowl, Thing::Books, Thing::Plant});
    const auto [side, along] = wall_of(*index);
    put_on_wall(make_mirror(kit_, kit_->draw(0.45f, 0.65f), kit_->draw(0.6f, 0.9f)), side, along,
                1.15f);
  }
  put(make_coat_rack(kit_), [&](const Asset& a) { return placer_.on_wall(a, 1.6f, {}); });
  const Rect& r = placer_.inner();
  const bool along_x = r.width() > r.depth();
  Piece runner = make_rug(kit_, std::min(3.5f, 0.4f * std::max(r.width(), r.depth())),
                          0.45f * std::min(r.width(), r.depth()));
  PlaceOptions flat;
  flat.flat = true;
  const Vec3 middle{(r.x0 + r.x1) / 2, 0, (r.z0 + r.z1) / 2};
  put(std::move(runner),
      [&](const Asset& a) { return placer_.try_at(a, placement(along_x ? 0 : 90, middle), flat); });
  plants(1);
  pictures(4);
}

}  // namespace lte::datagen::homes
