// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace fabloop {
namespace {

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin);
  if (from == std::string::npos) return "";
  const std::size_t to = text.find(end, from + begin.size());
  return to == std::string::npos ? "" : text.substr(from + begin.size(), to - from - begin.size());
}

TEST(Readme, ShowsTheExampleThatIsCompiled) {
  const std::filesystem::path root = FABLOOP_SOURCE_DIR;
  const std::string compiled =
      between(text_of(root / "tests" / "structure" / "readme_example.cpp"), "// README begins\n", "// README ends");
  const std::string shown = between(text_of(root / "README.md"), "```cpp\n", "```");
  ASSERT_FALSE(compiled.empty());
  EXPECT_EQ(shown, compiled);
}

}  // namespace
}  // namespace fabloop
