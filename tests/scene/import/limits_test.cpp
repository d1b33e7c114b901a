// What a scene may take: pictures and compressed data are refused before they are unfolded.
#include "lte/scene/import/limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/scene/import/compressed_file.h"
#include "lte/scene/import/limit_error.h"
#include "lte/scene/load.h"
#include "tests/scene/import/doors.h"
#include "tests/support/gzip.h"

namespace lte::scene {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(Limits, AreReadFromText) {
  EXPECT_EQ(parse_limits("").picture_bytes, 1'000'000'000);
  const LoadLimits limits = parse_limits("pictures=4GB,inflated=1.5GiB,triangles=2M,text=12");
  EXPECT_EQ(limits.picture_bytes, 4'000'000'000);
  EXPECT_EQ(limits.inflated_bytes, 1'610'612'736);
  EXPECT_EQ(limits.triangles, 2'000'000);
  EXPECT_EQ(limits.text_bytes, 12);
  EXPECT_EQ(limits.includes, LoadLimits{}.includes);
  EXPECT_EQ(parse_limits("pixels=3kB").texture_pixels, 3000);
  EXPECT_EQ(parse_limits("pixels=3ki").texture_pixels, 3072);
}

TEST(Limits, OfNoMeaningAreRefused) {
  for (const char* text :
       {"pictures", "pictures=", "pictures=many", "pictures=4XB", "pictures=-1", "pictures=4 GB",
        "pictures=1e30", "pictures=nan", "pictures=1,,", "=4"}) {
    EXPECT_THAT(test::error_of([&] { parse_limits(text); }), HasSubstr("limit \"")) << text;
  }
  EXPECT_THAT(test::error_of([&] { parse_limits("picture=1"); }),
              AllOf(HasSubstr("triangles, pixels, pictures"), HasSubstr("did you mean pictures?")));
}

/// A PNG that is a header and no more.
std::string png_header(uint32_t width, uint32_t height) {
  std::string out("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  for (const uint32_t side : {width, height}) {
    for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(side >> shift & 255);
  }
  return out + std::string("\x08\2\0\0\0\0\0\0\0", 9);
}

/// What refuses a scene: the name of the limit, the value needed, and the message.
struct Refused {
  std::string limit, message;
  int64_t needed = 0;
};

Refused refusal(const std::filesystem::path& scene, const LoadLimits& limits = {}) {
  try {
    load_scene(scene, limits);
  } catch (const OverLimit& error) {
    return {error.limit(), error.what(), error.needed()};
  } catch (const Error& error) {
    return {"", error.what(), 0};
  }
  return {};
}

class Budget : public ::testing::Test {
 protected:
  const test::Door& door(const std::string& name) {
    for (const test::Door& one : doors_) {
      if (one.name == name) return one;
    }
    throw Error("no door " + name);
  }
  std::filesystem::path write(const std::string& name, const std::string& reference) {
    const std::filesystem::path scene = dir_ / door(name).scene;
    door(name).write(scene, reference);
    return scene;
  }

  std::vector<test::Door> doors_ = test::doors();
  test::TempDir dir_;
};

TEST_F(Budget, HugePicturesAreRefusedByTheirHeader) {
  for (const char* name :
       {"gltf image", "glb image", "obj map_Kd", "pbrt imagemap", "pbrt area light"}) {
    // 5 bytes a pixel: 3 of color, and a third of the pixels in 6 bytes of mip levels.
    test::write_text(dir_ / "p.png", png_header(16000, 16000));
    Refused refused = refusal(write(name, "p.png"));
    EXPECT_EQ(refused.limit, "pictures") << name << refused.message;
    EXPECT_EQ(refused.needed, 1'280'000'000);
    EXPECT_THAT(refused.message,
                AllOf(HasSubstr("16000x16000 pixels"), HasSubstr("1.28 GB"), HasSubstr("1 GB")));
    for (const uint32_t side : {30'000u, 60'000u, 1'000'000u, 2'147'483'647u}) {
      test::write_text(dir_ / "p.png", png_header(side, side));
      refused = refusal(write(name, "p.png"));
      EXPECT_EQ(refused.limit, "pixels") << name << refused.message;
      EXPECT_THAT(refused.message,
                  AllOf(HasSubstr(concat(side, "x", side)), HasSubstr("268435456")));
    }
    // Allowed, there is still nothing behind the header.
    LoadLimits more;
    more.texture_pixels = more.picture_bytes = int64_t{1} << 50;
    test::write_text(dir_ / "p.png", png_header(60'000, 60'000));
    EXPECT_THAT(refusal(write(name, "p.png"), more).message,
                AllOf(HasSubstr("cannot decode"), HasSubstr("too large")));
  }
  test::write_text(dir_ / "p.png", png_header(9200, 9200));
  EXPECT_EQ(refusal(write("pbrt infinite light", "p.png")).needed, 9200ll * 9200 * 12);
}

TEST_F(Budget, PicturesCountTogether) {
  LoadLimits limits;
  limits.picture_bytes = 100 * 5 + 99 * 5;
  const auto picture = [&](const std::string& name) {
    image::write_png(dir_ / (name + ".png"), image::Image(10, 10, 3));
    return concat("Texture \"", name, "\" \"spectrum\" \"imagemap\" \"string filename\" \"", name,
                  ".png\"\nMaterial \"diffuse\" \"texture reflectance\" \"", name,
                  "\"\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n");
  };
  test::write_text(dir_ / "s.pbrt", "WorldBegin\n" + picture("a") + picture("b"));
  const Refused refused = refusal(dir_ / "s.pbrt", limits);
  EXPECT_EQ(refused.limit, "pictures");
  EXPECT_EQ(refused.needed, 1000);
  EXPECT_THAT(refused.message, AllOf(HasSubstr("s.pbrt:5"), HasSubstr("b.png: 10x10 pixels")));
  limits.picture_bytes = 1000;
  EXPECT_EQ(load_scene(dir_ / "s.pbrt", limits).textures.size(), 2u);
}

TEST_F(Budget, TexturesOfTexturesCount) {
  // A checkerboard of checkerboards, 256 texels a side in one period.
  test::write_text(dir_ / "s.pbrt",
                   "WorldBegin\nTexture \"c\" \"spectrum\" \"checkerboard\"\n"
                   "Material \"diffuse\" \"texture reflectance\" \"c\"\n"
                   "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n");
  const Scene scene = load_scene(dir_ / "s.pbrt");
  const int64_t pixels = int64_t{scene.textures.at(0)->width()} * scene.textures.at(0)->height();
  LoadLimits limits;
  limits.picture_bytes = pixels * 5;
  EXPECT_EQ(refusal(dir_ / "s.pbrt", limits).message, "");
  limits.picture_bytes = pixels * 5 - 1;
  EXPECT_EQ(refusal(dir_ / "s.pbrt", limits).limit, "pictures");
}

TEST_F(Budget, InflatedTextCountsOverTheScene) {
  const std::string triangle = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n";
  const std::string text = std::string(100'000, '\n') + triangle;
  const auto size = static_cast<int64_t>(text.size());
  test::write_text(dir_ / "part.pbrt.gz", test::gzip(text));
  test::write_text(dir_ / "twice.pbrt",
                   "WorldBegin\nInclude \"part.pbrt.gz\"\nInclude \"part.pbrt.gz\"\n");
  LoadLimits limits;
  limits.inflated_bytes = 2 * size;
  EXPECT_EQ(refusal(dir_ / "twice.pbrt", limits).message, "");
  limits.inflated_bytes = 2 * size - 1;
  const Refused refused = refusal(dir_ / "twice.pbrt", limits);
  EXPECT_EQ(refused.limit, "inflated");
  EXPECT_THAT(refused.message, AllOf(HasSubstr("part.pbrt.gz"), HasSubstr("of 200 kB")));
  // The scene's own file.
  test::write_text(dir_ / "own.pbrt.gz", test::gzip("WorldBegin\n" + text));
  limits.inflated_bytes = size;
  EXPECT_EQ(refusal(dir_ / "own.pbrt.gz", limits).limit, "inflated");
  limits.inflated_bytes = size + 11;
  EXPECT_EQ(refusal(dir_ / "own.pbrt.gz", limits).message, "");
}

TEST_F(Budget, ALyingLengthOfGzipDoesNotMatter) {
  std::string packed = test::gzip("WorldBegin\n" + std::string(50'000, ' ') +
                                  "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n");
  for (const char byte : {'\0', '\xff'}) {
    for (size_t i = 1; i <= 4; ++i) packed[packed.size() - i] = byte;
    test::write_text(dir_ / "lie.pbrt.gz", packed);
    EXPECT_THAT(refusal(dir_ / "lie.pbrt.gz").message, HasSubstr("damaged gzip"));
    LoadLimits limits;
    limits.inflated_bytes = 1000;
    EXPECT_EQ(refusal(dir_ / "lie.pbrt.gz", limits).limit, "inflated");
  }
}

TEST_F(Budget, TrianglesNameTheirLimit) {
  test::write_text(dir_ / "t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\n");
  LoadLimits limits;
  limits.triangles = 1;
  EXPECT_EQ(refusal(dir_ / "t.obj", limits).limit, "triangles");
  test::write_content(dir_.path(), "m");
  limits.triangles = 0;
  const Refused refused = refusal(dir_ / "m.ply", limits);
  EXPECT_EQ(refused.limit, "triangles");
  EXPECT_EQ(refused.needed, 1);
  EXPECT_EQ(refusal(write("pbrt plymesh", "m.ply"), limits).limit, "triangles");
}

TEST(SizeText, RoundsToThreeDigits) {
  EXPECT_EQ(size_text(640), "640 bytes");
  EXPECT_EQ(size_text(1'280'000'000), "1.28 GB");
  EXPECT_EQ(size_text(200'105), "200 kB");
}

}  // namespace
}  // namespace lte::scene
