// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/structure/structure_rules.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr const char* kHead = "// SPDX-License-Identifier: BSD-3-Clause\n";

/// A small tree in which every folder has one sound header.
class Structure : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) / ("fabloop_structure_" + std::to_string(getpid()));
    fs::remove_all(root_);
    for (const std::string folder : {"frontend", "verification", "posegraph", "data", "apps", "tests"}) {
      write(folder + "/sound.h", std::string(kHead) + "#pragma once\n");
    }
  }
  void TearDown() override { fs::remove_all(root_); }

  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text;
  }
  std::vector<std::string> violations_with(const std::string& name, const std::string& body) const {
    write(name, kHead + body);
    return structure_violations(root_);
  }

  fs::path root_;
};

TEST_F(Structure, ASoundTreePasses) {
  write("posegraph/residuals/residuals.h", std::string(kHead) + "#pragma once\n#include <ceres/ceres.h>\n");
  write("verification/solver.cpp", std::string(kHead) + "#include <opengv/types.hpp>\n#include \"frontend/sound.h\"\n");
  write("apps/main.cpp", std::string(kHead) + "#include <iostream>\n#include \"data/sound.h\"\n#include \"posegraph/sound.h\"\n");
  EXPECT_THAT(structure_violations(root_), IsEmpty());
}

TEST_F(Structure, AnIncludeThatPointsRightIsFound) {
  EXPECT_THAT(violations_with("frontend/a.cpp", "#include \"verification/sound.h\"\n"),
              ElementsAre("frontend/a.cpp:2: frontend may not include verification"));
}

TEST_F(Structure, EveryForbiddenDirectionIsFound) {
  const std::vector<std::pair<std::string, std::string>> forbidden{
      {"frontend", "posegraph"}, {"frontend", "data"},  {"frontend", "apps"},  {"verification", "posegraph"},
      {"verification", "data"},  {"posegraph", "apps"}, {"posegraph", "data"}, {"data", "verification"},
      {"data", "posegraph"},     {"data", "apps"},      {"apps", "tests"},     {"frontend", "tests"}};
  for (const auto& [from, to] : forbidden) {
    EXPECT_THAT(violations_with(from + "/a.cpp", "#include \"" + to + "/sound.h\"\n"),
                ElementsAre(from + "/a.cpp:2: " + from + " may not include " + to));
    fs::remove(root_ / from / "a.cpp");
  }
}

TEST_F(Structure, AnIncludeThatIsNoPathFromTheRootIsFound) {
  EXPECT_THAT(violations_with("frontend/a.cpp", "#include \"sound.h\"\n"),
              ElementsAre("frontend/a.cpp:2: 'sound.h' is no path from the root"));
}

TEST_F(Structure, OpenGvAndCeresOutOfPlaceAreFound) {
  EXPECT_THAT(violations_with("verification/a.h", "#pragma once\n#include <opengv/types.hpp>\n"),
              ElementsAre("verification/a.h:3: OpenGV belongs in verification's .cpp files"));
  fs::remove(root_ / "verification/a.h");
  EXPECT_THAT(violations_with("posegraph/a.h", "#pragma once\n#include <ceres/ceres.h>\n"),
              ElementsAre("posegraph/a.h:3: Ceres belongs in posegraph's .cpp files and residuals/"));
}

TEST_F(Structure, MissingHeadsAndPragmasAreFound) {
  write("data/a.h", "int a;\n");
  EXPECT_THAT(structure_violations(root_),
              ElementsAre("data/a.h:1: the licence head is missing", "data/a.h:1: '#pragma once' is missing"));
}

TEST_F(Structure, PrintingAndUnfinishedWorkAreFound) {
  const std::string mark = std::string("TO") + "DO";
  EXPECT_THAT(violations_with("data/a.cpp", "#include <iostream>\n// " + mark + ": later\n"),
              ElementsAre("data/a.cpp:2: the library does not print", "data/a.cpp:3: '" + mark + "' is left"));
}

TEST(ThisRepository, KeepsTheRules) { EXPECT_THAT(structure_violations(FABLOOP_SOURCE_DIR), IsEmpty()); }

}  // namespace
}  // namespace fabloop
