// Scenes of strangers: what a file may name, and what is said of files that it may not.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "lte/scene/import/scene_files.h"
#include "lte/scene/load.h"
#include "tests/scene/import/doors.h"

namespace lte::scene {
namespace {

using test::Door;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

LoadLimits outside_allowed() {
  LoadLimits limits;
  limits.outside = true;
  return limits;
}

/// Good files of every kind inside and outside the folder of a scene.
class Untrusted : public ::testing::Test {
 protected:
  Untrusted() {
    test::write_content(dir_ / "scene", "in");
    test::write_content(dir_ / "scene" / "sub", "deep");
    test::write_content(dir_.path(), "out");
    test::write_content(dir_ / "scene-too", "out");
  }

  fs::path scene(const Door& door) const { return dir_ / "scene" / door.scene; }

  /// What loading a scene with this reference throws; "" if it loads.
  std::string outcome(const Door& door, const std::string& reference,
                      const LoadLimits& limits = {}) const {
    door.write(scene(door), reference);
    try {
      notes_ = load_scene(scene(door), limits).ignored;
      return "";
    } catch (const OutsideFolder& refusal) {
      return concat("outside: ", refusal.what());
    } catch (const Error& error) {
      return error.what();
    }
  }

  static const Door& door(const std::string& name) {
    static const std::vector<Door> all = test::doors();
    for (const Door& one : all) {
      if (one.name == name) return one;
    }
    throw Error("no door " + name);
  }

  test::TempDir dir_;
  mutable std::vector<std::string> notes_;
};

class EveryDoor : public Untrusted, public ::testing::WithParamInterface<Door> {};

INSTANTIATE_TEST_SUITE_P(All, EveryDoor, ::testing::ValuesIn(test::doors()),
                         [](const auto& instance) {
                           std::string name = instance.param.name;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

TEST_P(EveryDoor, OpensWhatLiesInTheFolderOrBelow) {
  const std::string e = GetParam().content;
  fs::create_symlink("sub/deep" + e, dir_ / "scene" / ("link" + e));
  fs::create_symlink(dir_ / "scene" / "sub" / ("deep" + e), dir_ / "scene" / ("far" + e));
  fs::create_directory_symlink("sub", dir_ / "scene" / "twin");
  for (const std::string name : {"in", "./in", "sub/deep", "sub/../in", "link", "far", "twin/deep",
                                 "../scene/in", "sub/.././sub/deep"}) {
    EXPECT_EQ(outcome(GetParam(), name + e), "") << name;
    EXPECT_THAT(notes_, Not(::testing::Contains(HasSubstr("not there")))) << name;
  }
}

TEST_P(EveryDoor, IsShutToWhatLiesOutside) {
  const std::string e = GetParam().content;
  fs::create_symlink("../out" + e, dir_ / "scene" / ("link" + e));
  fs::create_symlink(dir_ / ("out" + e), dir_ / "scene" / ("far" + e));
  fs::create_symlink("link" + e, dir_ / "scene" / ("chain" + e));
  fs::create_directory_symlink("..", dir_ / "scene" / "up");
  fs::create_directory_symlink("../../scene-too", dir_ / "scene" / "sub" / "side");
  for (const std::string name :
       {"../out", "sub/../../out", "link", "far", "chain", "up/out", "sub/side/out",
        "../scene-too/out", "up/scene/../out", "././../out"}) {
    EXPECT_THAT(outcome(GetParam(), name + e),
                AllOf(HasSubstr("outside: "), HasSubstr("scene"), HasSubstr('"' + name + e + '"')))
        << name;
    EXPECT_EQ(outcome(GetParam(), name + e, outside_allowed()), "") << name;
    EXPECT_THAT(notes_, Not(::testing::Contains(HasSubstr("not there")))) << name;
  }
}

TEST_P(EveryDoor, DoesNotTellWhatThereIsOutside) {
  const std::string e = GetParam().content;
  fs::create_symlink("../nothing" + e, dir_ / "scene" / ("dangling" + e));
  for (const std::string name :
       {"../nothing", "../nothing/at/all", "../../../../../etc/nothing", "dangling"}) {
    EXPECT_THAT(outcome(GetParam(), name + e), HasSubstr("outside: ")) << name;
  }
  EXPECT_THAT(outcome(GetParam(), "../../../../../../../../etc/passwd"), HasSubstr("outside: "));
}

TEST_P(EveryDoor, DoesNotOpenDevicesPipesAndFolders) {
  const std::string e = GetParam().content;
  ASSERT_EQ(mkfifo((dir_ / "scene" / ("pipe" + e)).c_str(), 0600), 0);
  fs::create_directory(dir_ / "scene" / ("folder" + e));
  fs::create_symlink("/dev/zero", dir_ / "scene" / ("zero" + e));
  const bool is_obj = GetParam().scene.ends_with(".obj");
  for (const std::string name : {"pipe", "folder"}) {
    const std::string message = outcome(GetParam(), name + e);  // and does not wait for a writer
    if (is_obj) {
      EXPECT_THAT(notes_, ::testing::Contains(HasSubstr("not there"))) << name;
    } else {
      EXPECT_THAT(message, HasSubstr("is not a regular file")) << name;
    }
  }
  EXPECT_THAT(outcome(GetParam(), "zero" + e), HasSubstr("outside: "));
  const std::string allowed = outcome(GetParam(), "zero" + e, outside_allowed());
  EXPECT_THAT(allowed, is_obj ? HasSubstr("") : HasSubstr("is not a regular file"));
}

TEST_F(Untrusted, PercentEncodingHidesNothing) {
  for (const char* name : {"gltf image", "glb image", "gltf buffer", "glb buffer"}) {
    const std::string e = door(name).content;
    EXPECT_EQ(outcome(door(name), "sub%2Fdeep" + e), "");
    for (const std::string reference :
         {"..%2Fout", "%2e%2e/out", "%2E%2E%2Fout", "sub/%2e./../out"}) {
      EXPECT_THAT(outcome(door(name), reference + e),
                  AllOf(HasSubstr("outside: "), HasSubstr('"' + reference + e + '"')));
    }
    EXPECT_THAT(outcome(door(name), "in%00" + e), HasSubstr("cannot find the file"));
  }
}

TEST_F(Untrusted, AbsoluteNames) {
  for (const char* name : {"gltf image", "glb image", "gltf buffer", "glb buffer"}) {
    const std::string file = (dir_ / ("out" + door(name).content)).string();
    for (const std::string& reference : {file, "file://" + file, "http://127.0.0.1" + file})
      EXPECT_THAT(outcome(door(name), reference, outside_allowed()), HasSubstr("nothing else is"));
  }
  for (const char* name : {"pbrt Include", "pbrt plymesh", "pbrt imagemap", "pbrt spectrum"}) {
    const std::string e = door(name).content;
    EXPECT_THAT(outcome(door(name), (dir_ / ("out" + e)).string()), HasSubstr("outside: "));
    EXPECT_EQ(outcome(door(name), (dir_ / "scene" / ("in" + e)).string()), "");
    EXPECT_EQ(outcome(door(name), (dir_ / ("out" + e)).string(), outside_allowed()), "");
  }
  // Of names from other machines OBJ takes the last part.
  for (const char* name : {"obj mtllib", "obj map_Kd"}) {
    const std::string e = door(name).content;
    EXPECT_EQ(outcome(door(name), (dir_ / ("out" + e)).string(), outside_allowed()), "");
    EXPECT_THAT(notes_, ::testing::Contains(HasSubstr("not there")));
    EXPECT_EQ(outcome(door(name), "C:\\models\\in" + e), "");
    EXPECT_THAT(notes_, Not(::testing::Contains(HasSubstr("not there"))));
  }
}

TEST_F(Untrusted, BackslashesDivideFoldersInObj) {
  for (const char* name : {"obj mtllib", "obj map_Kd"}) {
    const std::string e = door(name).content;
    EXPECT_EQ(outcome(door(name), "sub\\deep" + e), "");
    EXPECT_THAT(notes_, Not(::testing::Contains(HasSubstr("not there"))));
    EXPECT_THAT(outcome(door(name), "..\\out" + e), HasSubstr("outside: "));
    EXPECT_EQ(outcome(door(name), "..\\textures\\in" + e), "") << "found beside the file";
  }
}

TEST_F(Untrusted, IncludedFilesDoNotWidenTheFolder) {
  fs::create_directories(dir_ / "scene" / "a" / "b");
  const Door& include = door("pbrt Include");
  const auto nested = [&](const std::string& reference) {
    test::write_text(dir_ / "scene" / "a" / "one.pbrt", "Include \"b/two.pbrt\"\n");
    test::write_text(dir_ / "scene" / "a" / "b" / "two.pbrt",
                     "Shape \"plymesh\" \"string filename\" \"" + reference + "\"\n");
    return outcome(include, "a/one.pbrt");
  };
  EXPECT_EQ(nested("../../in.ply"), "");
  EXPECT_EQ(nested("../../sub/deep.ply"), "");
  EXPECT_EQ(nested("in.ply"), "") << "beside the scene, as nothing is beside the file";
  EXPECT_THAT(nested("../../../out.ply"),
              AllOf(HasSubstr("two.pbrt:1"), HasSubstr("../../../out.ply"), HasSubstr("outside")));
  // A link to a folder elsewhere makes nothing there part of the scene.
  fs::create_directory_symlink("../../scene-too", dir_ / "scene" / "a" / "away");
  EXPECT_THAT(nested("../away/out.ply"), HasSubstr("outside"));
}

/// The first line of /etc/passwd, which is none of the formats.
const std::string kSecret = "root:x:0:0:root:/root:/bin/bash\n";

TEST_F(Untrusted, NothingOfAFileOutsideIsQuoted) {
  const auto quotes_nothing =
      AllOf(Not(HasSubstr("root")), Not(HasSubstr("bash")), Not(HasSubstr("x:0")));
  const auto with = [&](const char* name, const std::string& content) {
    const std::string file = "secret" + door(name).content;
    test::write_text(dir_ / file, content);
    const std::string message = outcome(door(name), "../" + file, outside_allowed());
    EXPECT_THAT(message, quotes_nothing) << name;
    return message;
  };
  EXPECT_THAT(with("pbrt Include", kSecret), HasSubstr("secret.pbrt:1: unknown directive"));
  EXPECT_THAT(with("pbrt Include", "\nShape \"root:x:0\" \"root:x\""),
              HasSubstr("secret.pbrt:2: "));
  EXPECT_THAT(with("pbrt Include", "Translate root 0 0"), HasSubstr("expected a number"));
  EXPECT_THAT(with("pbrt Include", "Include \"root\""), HasSubstr("cannot find the file"));
  EXPECT_THAT(with("pbrt plymesh", kSecret), HasSubstr("not a valid PLY mesh"));
  EXPECT_THAT(with("pbrt plymesh", "ply\nformat ascii 1.0\nelement root:x:0 bash\n"),
              HasSubstr("secret.ply:3: not a valid PLY mesh"));
  EXPECT_THAT(with("pbrt imagemap", "PF\nroot:x:0 4\n-1\n"), HasSubstr("not a valid picture"));
  EXPECT_THAT(with("pbrt spectrum", kSecret), HasSubstr("secret.spd:1: expected a number"));
  EXPECT_THAT(with("obj mtllib", "newmtl a\nKd root:x:0\n"), HasSubstr("secret.mtl: line 2: "));
  EXPECT_EQ(with("gltf image", kSecret), "") << "a picture in no known format is a note";
}

TEST_F(Untrusted, NotesDoNotQuoteFilesOutsideEither) {
  test::write_text(dir_ / "notes.pbrt",
                   "Shape \"root:x:0\"\nMaterial \"root:x\"\nShape \"sphere\" \"float bash\" 1\n");
  test::write_text(dir_ / "notes.mtl", "newmtl a\nmap_Kd root:x:0\n");
  for (const auto& [name, file] :
       {std::pair("pbrt Include", "../notes.pbrt"), std::pair("obj mtllib", "../notes.mtl")}) {
    EXPECT_EQ(outcome(door(name), file, outside_allowed()), "");
    EXPECT_FALSE(notes_.empty());
    for (const std::string& note : notes_)
      EXPECT_THAT(note, AllOf(Not(HasSubstr("root")), Not(HasSubstr("bash")))) << name;
  }
}

TEST_F(Untrusted, ValuesOfBuffersOutsideAreNotShown) {
  test::GltfBuilder builder;
  test::Json primitive = builder.triangle();
  primitive["indices"] = builder.accessor(std::vector<uint32_t>{0, 1, 1953460082}, 5125, "SCALAR");
  builder.mesh(primitive);
  builder.save_external(dir_ / "scene" / "scene.gltf", "../secret.bin", "../secret.bin");
  const std::string message =
      test::error_of([&] { load_scene(dir_ / "scene" / "scene.gltf", outside_allowed()); });
  EXPECT_THAT(message, AllOf(HasSubstr("index 2"), Not(HasSubstr("1953460082"))));
}

TEST_F(Untrusted, TheSceneItselfMayBeALink) {
  fs::create_directory(dir_ / "links");
  const Door& image = door("gltf image");
  image.write(scene(image), "in.png");
  fs::create_symlink("../scene/scene.gltf", dir_ / "links" / "scene.gltf");
  // What it names is looked for beside the link, and that folder is the scene's.
  EXPECT_THAT(test::error_of([&] { load_scene(dir_ / "links" / "scene.gltf"); }),
              HasSubstr("cannot find the file \"in.png\""));
  test::write_content(dir_ / "links", "in");
  EXPECT_EQ(load_scene(dir_ / "links" / "scene.gltf").textures.size(), 1u);
}

TEST_F(Untrusted, ScenesWithoutAFolderInTheirName) {
  const fs::path before = fs::current_path();
  fs::current_path(dir_ / "scene");
  std::vector<std::string> messages;
  for (const char* name : {"gltf image", "pbrt plymesh", "obj map_Kd"}) {
    for (const char* reference : {"in", "../out", "gone"}) {
      door(name).write(door(name).scene, reference + door(name).content);
      try {
        load_scene(door(name).scene);
        messages.emplace_back();
      } catch (const Error& error) {
        messages.emplace_back(error.what());
      }
    }
  }
  fs::current_path(before);
  for (size_t i = 0; i < messages.size(); i += 3) {
    EXPECT_EQ(messages[i], "");
    EXPECT_THAT(messages[i + 1], HasSubstr("outside"));
    EXPECT_THAT(messages[i + 2], AnyOf("", HasSubstr("cannot find the file")));
  }
}

/// Somebody exchanges a folder for a link to another one again and again while its file is opened:
/// a look at the name before opening it would let some of these through.
TEST_F(Untrusted, ExchangedFoldersDoNotHelp) {
  test::write_text(dir_ / "scene" / "sub" / "a.txt", "mine");
  test::write_text(dir_ / "scene-too" / "a.txt", "secret");
  const fs::path sub = dir_ / "scene" / "sub", other = dir_ / "scene" / "other";
  fs::create_directory_symlink("../scene-too", other);
  std::atomic<bool> stop{false};
  std::thread exchange([&] {
    while (!stop) renameat2(AT_FDCWD, sub.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE);
  });
  int opened = 0, refused = 0;
  for (int run = 0; run < 3000; ++run) {
    SceneFiles files(dir_ / "scene" / "scene.obj", {});
    try {
      const SceneFilePtr file = files.open({sub / "a.txt"}, "sub/a.txt", "scene.obj");
      if (!file) continue;
      ++opened;
      EXPECT_EQ(file->text(), "mine");
    } catch (const OutsideFolder&) {
      ++refused;
    } catch (const Error&) {  // exchanged while the system resolved it
    }
  }
  stop = true;
  exchange.join();
  EXPECT_GT(opened + refused, 0);
}

}  // namespace
}  // namespace lte::scene
