#include "infer/view/page_files.h"

#include <fstream>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "lte/base/check.h"
#include "tests/support/temp_dir.h"

namespace lte::infer::view {
namespace {

const std::string kPage = std::string(LTE_SOURCE_DIR) + "/infer/view/page";

TEST(PageFiles, OnlyWhatIsInTheTableIsFound) {
  const PageFiles files(kPage);
  ASSERT_NE(files.find("/"), nullptr);
  EXPECT_EQ(files.find("/"), files.find("/index.html"));
  EXPECT_EQ(files.find("/main.js")->media_type, "text/javascript; charset=utf-8");
  for (const char* path : {"/../CMakeLists.txt", "/../page/main.js", "//main.js", "/./main.js",
                           "/%2e%2e/CMakeLists.txt", "/main.js/", "main.js", "", "/socket",
                           "/etc/passwd", "/..", "/style.css?"})
    EXPECT_EQ(files.find(path), nullptr) << path;
}

TEST(PageFiles, OtherFilesOfTheFolderStayPrivate) {
  const test::TempDir folder;
  std::ofstream(folder / "index.html") << "page";
  std::ofstream(folder / "notes.txt") << "private";
  std::ofstream(folder / "main.js~") << "old";
  const PageFiles files(folder.path());
  EXPECT_NE(files.find("/"), nullptr);
  EXPECT_EQ(files.find("/notes.txt"), nullptr);
  EXPECT_EQ(files.find("/main.js~"), nullptr);
}

TEST(PageFiles, AFolderWithoutAPageIsRefused) {
  const test::TempDir folder;
  EXPECT_THROW(PageFiles{folder.path()}, Error);
}

/// Every file that the page asks for is there, and nothing comes from elsewhere.
TEST(PageFiles, ThePageIsWhole) {
  const PageFiles files(kPage);
  const auto check = [&](const char* name, const std::string& pattern) {
    const PageFile* file = files.find(name);
    ASSERT_NE(file, nullptr) << name;
    const std::regex reference(pattern);
    for (std::sregex_iterator at(file->bytes.begin(), file->bytes.end(), reference), end; at != end;
         ++at)
      EXPECT_NE(files.find("/" + (*at)[1].str()), nullptr) << name << ": " << (*at)[1];
  };
  check("/index.html", "(?:src|href)=\"([^\"]*)\"");
  for (const char* module :
       {"/main.js", "/camera.js", "/color.js", "/connection.js", "/controls.js", "/dom.js",
        "/lights_panel.js", "/materials_panel.js", "/meter.js", "/objects_panel.js", "/picture.js",
        "/saving.js", "/store.js", "/vector.js", "/view_panel.js"}) {
    check(module, "from \"\\./([^\"]*)\"");
  }
}

}  // namespace
}  // namespace lte::infer::view
