// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/fabmap2_io.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <limits>
#include <optional>
#include <sstream>
#include <string>

#include "frontend/error.h"

namespace fabloop {
namespace {

/// One line of a table, commas made spaces, and where it stands.
struct Line {
  std::istringstream stream;
  std::string where;  ///< File and number.

  [[noreturn]] void fail(const std::string& what) const { throw InputError(where + ": " + what); }

  void require_end() {
    stream >> std::ws;
    if (!stream.eof()) fail("there is more on the line than expected");
  }
};

void for_each_line(const std::filesystem::path& path, const std::function<void(Line&)>& parse) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) throw InputError(path.string() + ": cannot be read; does it exist?");
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    if (!text.empty() && text.back() == '\r') text.pop_back();
    if (text.empty() || text[0] == '#') continue;
    std::replace(text.begin(), text.end(), ',', ' ');
    Line line{std::istringstream(text), path.string() + ":" + std::to_string(number)};
    parse(line);
  }
}

ChowLiuNode parse_node(Line& line, std::size_t expected_word) {
  std::size_t word = 0;
  long parent = 0;
  double p = 0.0, p_if_parent = 0.0, p_unseen_if_no_parent = 0.0;
  if (!(line.stream >> word >> parent >> p >> p_if_parent >> p_unseen_if_no_parent)) {
    line.fail("expected word,parent,p(z=1),p(z=1 given parent=1),p(z=0 given parent=0)");
  }
  line.require_end();
  if (word != expected_word) {
    line.fail("word " + std::to_string(word) + " where word " + std::to_string(expected_word) + " is due");
  }
  if (parent < -1 || parent > static_cast<long>(std::numeric_limits<WordId>::max())) {
    line.fail("parent " + std::to_string(parent) + " is neither a word nor -1");
  }
  const auto is_probability = [](double value) { return value > 0.0 && value < 1.0; };
  if (!is_probability(p) || !is_probability(p_if_parent) || !is_probability(p_unseen_if_no_parent)) {
    line.fail("a probability that is not strictly between 0 and 1");
  }
  if (parent < 0) return {std::nullopt, p, p, p};
  return {static_cast<WordId>(parent), p, p_if_parent, 1.0 - p_unseen_if_no_parent};
}

/// "17:2": word 17, seen twice.
WordId parse_word(const Line& line, const std::string& entry, std::size_t num_words) {
  std::istringstream stream(entry);
  unsigned long word = 0, count = 0;
  char colon = 0;
  if (!(stream >> word >> colon >> count) || colon != ':' || !stream.eof()) line.fail("\"" + entry + "\" is not word:count");
  if (word >= num_words) {
    line.fail("word " + std::to_string(word) + " but there are only " + std::to_string(num_words) + " words");
  }
  return static_cast<WordId>(word);
}

}  // namespace

ChowLiuTree read_fabmap2_tree(const std::filesystem::path& path) {
  ChowLiuTree tree;
  for_each_line(path, [&](Line& line) { tree.nodes.push_back(parse_node(line, tree.nodes.size())); });
  validate(tree, path.string());
  return tree;
}

std::map<int, Observation> read_fabmap2_images(const std::filesystem::path& path, std::size_t num_words) {
  std::map<int, Observation> images;
  for_each_line(path, [&](Line& line) {
    int image = 0, num_keypoints = 0;
    std::string name, entry;
    if (!(line.stream >> image >> name >> num_keypoints)) line.fail("expected image,name,keypoints,word:count ...");
    if (images.contains(image)) line.fail("image " + std::to_string(image) + " comes twice");
    std::vector<WordId>& words = images[image].words;
    while (line.stream >> entry) words.push_back(parse_word(line, entry, num_words));
    std::sort(words.begin(), words.end());
    if (std::adjacent_find(words.begin(), words.end()) != words.end()) line.fail("a word comes twice");
  });
  return images;
}

FabMap2Model read_fabmap2(const std::filesystem::path& folder) {
  FabMap2Model model;
  model.tree = read_fabmap2_tree(folder / "chow_liu_tree.csv");
  model.observations = read_fabmap2_images(folder / "bow.csv", model.tree.num_words());
  for_each_line(folder / "gt_pairs.csv", [&](Line& line) {
    std::pair<int, int> images;
    if (!(line.stream >> images.first >> images.second)) line.fail("expected query,match");
    line.require_end();
    for (const int image : {images.first, images.second}) {
      if (!model.observations.contains(image)) line.fail("image " + std::to_string(image) + " is not in bow.csv");
    }
    model.true_pairs.push_back(images);
  });
  return model;
}

}  // namespace fabloop
