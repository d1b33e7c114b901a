#include "infer/view/messages.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"

namespace lte::infer::view {
namespace {

using testing::HasSubstr;

std::string fault_of(const std::string& text) {
  try {
    parse_message(text);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

template <typename T>
T parse(const std::string& text) {
  return std::get<T>(parse_message(text).request);
}

TEST(Messages, ReadsEveryType) {
  EXPECT_EQ(parse<Hello>(R"({"type":"hello","protocol":1,"n":1})").protocol, 1);
  const auto camera = parse<MoveCamera>(
      R"({"type":"camera","n":2,"origin":[1,2,3],"target":[1,2,-4.5],"up":[0,1,0],"vfov":50})");
  EXPECT_EQ(camera.camera.origin, (Vec3{1, 2, 3}));
  EXPECT_EQ(camera.camera.target, (Vec3{1, 2, -4.5f}));
  EXPECT_EQ(camera.camera.vfov, 50);
  const auto view = parse<ChangeView>(
      R"({"type":"view","n":3,"shown":"irradiance","ev":-1.5,"curve":"filmic","size":[64,48],"meter":true})");
  EXPECT_EQ(view.shown, Shown::Irradiance);
  EXPECT_EQ(view.ev, -1.5f);
  EXPECT_EQ(view.curve, ToneCurve::Filmic);
  EXPECT_EQ(view.size, (PictureSize{64, 48}));
  EXPECT_TRUE(view.meter);
  const auto light = parse<MakeEdit>(
      R"({"type":"light","n":4,"gesture":7,"light":2,"gain":0.5,"color":[1,0.5,0]})");
  EXPECT_EQ(light.gesture, 7);
  EXPECT_EQ(light.edit, PageEdit(LightSetting{2, 0.5f, {1, 0.5f, 0}, {}}));
  EXPECT_EQ(
      parse<MakeEdit>(R"({"type":"material","n":5,"gesture":0,"material":1,"albedo":[0,0.25,1]})")
          .edit,
      PageEdit(MaterialSetting{1, {0, 0.25f, 1}}));
  EXPECT_EQ(
      parse<MakeEdit>(
          R"({"type":"object","n":6,"gesture":0,"object":3,"move":[0,0,1],"turn":90,"scale":2})")
          .edit,
      PageEdit(ObjectSetting{3, {{0, 0, 1}, 90, 2}}));
  const auto copy = parse<CopyObject>(R"({"type":"copy_object","n":7,"object":3,"move":[1,0,-2]})");
  EXPECT_EQ(copy.object, 3);
  EXPECT_EQ(copy.move, (Vec3{1, 0, -2}));
  EXPECT_EQ(parse<RemoveObject>(R"({"type":"remove_object","n":7,"object":4})").object, 4);
  const auto lamp = parse<AddLamp>(
      R"({"type":"add_light","n":7,"kind":"spot","position":[1,2,3],"direction":[1,0,0],"intensity":[4,5,6]})");
  EXPECT_EQ(lamp.kind, scene::LightKind::Spot);
  EXPECT_EQ(lamp.position, (Vec3{1, 2, 3}));
  EXPECT_EQ(lamp.direction, (Vec3{1, 0, 0}));
  EXPECT_EQ(lamp.intensity, (Rgb{4, 5, 6}));
  EXPECT_FALSE(
      parse<AddLamp>(R"({"type":"add_light","n":7,"kind":"point","position":[1,2,3]})").intensity);
  EXPECT_EQ(parse<RemoveLamp>(R"({"type":"remove_light","n":7,"light":2})").light, 2);
  const auto turned = parse<MakeEdit>(
      R"({"type":"light","n":7,"gesture":0,"light":2,"gain":1,"color":[1,1,1],"direction":[0,-1,0]})");
  EXPECT_EQ(std::get<LightSetting>(turned.edit).direction, (Vec3{0, -1, 0}));
  EXPECT_EQ(parse<PickAt>(R"({"type":"pick","n":7,"x":0.25,"y":1})").x, 0.25f);
  EXPECT_EQ(parse<Save>(R"({"type":"save","n":8,"format":"glb"})").format, SaveFormat::Glb);
  EXPECT_EQ(parse<Shows>(R"({"type":"shows","n":9,"picture":12})").picture, 12);
  parse<Undo>(R"({"type":"undo","n":10})");
  parse<Redo>(R"({"type":"redo","n":11})");
  EXPECT_EQ(parse_message(R"({"type":"reset","n":12})").number, 12);
}

TEST(Messages, WhatIsMissingOfAViewStays) {
  const auto view = parse<ChangeView>(R"({"type":"view","n":1,"ev":2})");
  EXPECT_FALSE(view.shown || view.curve || view.size || view.meter);
}

TEST(Messages, AFaultNamesTypeAndKey) {
  EXPECT_THAT(fault_of(R"({"type":"pick","n":1,"x":0.5})"),
              HasSubstr("message pick: y: is missing"));
  EXPECT_THAT(fault_of(R"({"type":"pick","n":1,"x":0.5,"y":1.01})"),
              HasSubstr("y: expected a number of 0 to 1"));
  EXPECT_THAT(fault_of(R"({"type":"undo","n":1,"all":true})"), HasSubstr("unknown key \"all\""));
  EXPECT_THAT(fault_of(R"({"type":"undo"})"), HasSubstr("n: is missing"));
  EXPECT_THAT(fault_of(R"({"type":"undi","n":1})"), HasSubstr("unknown message type \"undi\""));
  EXPECT_THAT(fault_of(R"({"type":"save","n":1,"format":"/etc/passwd"})"),
              HasSubstr("message save: format: expected png | exr | camera | glb"));
}

TEST(Messages, RefusesWhatIsNoMessageInOneLine) {
  const std::vector<std::string> garbage = {
      "",
      " ",
      "null",
      "[]",
      "42",
      "\"undo\"",
      "{",
      "{}",
      "{\"type\":3}",
      "{\"type\":null,\"n\":1}",
      std::string(1, '\0'),
      "\xff\xfe{}",
      "{\"type\":\"un\xc3\",\"n\":1}",
      R"({"type":"undo","n":0})",
      R"({"type":"undo","n":-1})",
      R"({"type":"undo","n":1.5})",
      R"({"type":"undo","n":18446744073709551615})",
      R"({"type":"undo","n":"1"})",
      R"({"type":"undo","n":1}{"type":"undo","n":2})",
      R"({"type":"add_light","n":1,"kind":"sun","position":[0,0,0]})",
      R"({"type":"add_light","n":1,"kind":"point"})",
      R"({"type":"add_light","n":1,"kind":"spot","position":[0,0,0],"direction":[0,0,0]})",
      R"({"type":"add_light","n":1,"kind":"point","position":[0,0,0],"intensity":[-1,0,0]})",
      R"({"type":"light","n":1,"gesture":0,"light":0,"gain":1,"color":[1,1,1],"direction":[0,0,0]})",
      R"({"type":"copy_object","n":1,"object":1})",
      R"({"type":"copy_object","n":1,"object":-1,"move":[0,0,0]})",
      R"({"type":"remove_object","n":1,"object":1.5})",
      R"({"type":"remove_light","n":1})",
      R"({"type":"pick","n":1,"x":1e999,"y":0})",
      R"({"type":"pick","n":1,"x":NaN,"y":0})",
      R"({"type":"pick","n":1,"x":"0","y":0})",
      R"({"type":"camera","n":1,"origin":[0,0],"target":[0,0,1],"up":[0,1,0],"vfov":40})",
      R"({"type":"camera","n":1,"origin":[0,0,0],"target":[0,0,0],"up":[0,1,0],"vfov":40})",
      R"({"type":"camera","n":1,"origin":[0,0,0],"target":[0,2,0],"up":[0,1,0],"vfov":40})",
      R"({"type":"camera","n":1,"origin":[0,0,0],"target":[0,0,1],"up":[0,0,0],"vfov":40})",
      R"({"type":"camera","n":1,"origin":[0,0,0],"target":[0,0,1],"up":[0,1,0],"vfov":180})",
      R"({"type":"camera","n":1,"origin":[0,0,1e30],"target":[0,0,1],"up":[0,1,0],"vfov":40})",
      R"({"type":"view","n":1,"size":[100000,100000]})",
      R"({"type":"view","n":1,"size":[64.5,48]})",
      R"({"type":"view","n":1,"shown":"everything"})",
      R"({"type":"view","n":1,"meter":1})",
      R"({"type":"light","n":1,"gesture":0,"light":0,"gain":-1,"color":[1,1,1]})",
      R"({"type":"light","n":1,"gesture":0,"light":0,"gain":1,"color":[0,0,0]})",
      R"({"type":"light","n":1,"gesture":0,"light":-1,"gain":1,"color":[1,1,1]})",
      R"({"type":"light","n":1,"gesture":0,"light":1e3,"gain":1,"color":[1,1,1]})",
      R"({"type":"material","n":1,"gesture":0,"material":0,"albedo":[2,0,0]})",
      R"({"type":"object","n":1,"gesture":0,"object":0,"move":[0,0,0],"turn":0,"scale":0})"};
  for (const std::string& text : garbage) {
    const std::string fault = fault_of(text);
    EXPECT_FALSE(fault.empty()) << text;
    EXPECT_EQ(fault.find('\n'), std::string::npos) << fault;
    EXPECT_LT(fault.size(), 300u) << fault;
  }
}

TEST(Messages, DepthAndLengthAreBounded) {
  EXPECT_THAT(fault_of(std::string(kMaxMessageBytes + 1, ' ')), HasSubstr("16384 at most"));
  const std::string deep =
      "{\"type\":\"undo\",\"n\":1,\"x\":" + std::string(8000, '[') + std::string(8000, ']') + "}";
  EXPECT_THAT(fault_of(deep), HasSubstr("unknown key \"x\""));
  EXPECT_THAT(fault_of("{\"type\":\"" + std::string(5000, 'a') + "\",\"n\":1}"),
              HasSubstr("unknown message type \"aaaa"));
}

}  // namespace
}  // namespace lte::infer::view
