// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/fabmap2_model.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include "frontend/error.h"

namespace fabloop::testing {
namespace {

/// Calls `parse` with each line that is no comment, as a stream in which commas are spaces.
void for_each_line(const std::filesystem::path& path, const std::function<bool(std::istringstream&)>& parse) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be read");
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream stream(line);
    if (!parse(stream)) throw InputError(path.string() + ":" + std::to_string(number) + ": not understood");
  }
}

}  // namespace

FabMap2Model read_fabmap2(const std::filesystem::path& folder) {
  FabMap2Model model;
  for_each_line(folder / "chow_liu_tree.csv", [&](std::istringstream& line) {
    std::size_t word = 0;
    int parent = 0;
    double p = 0.0, p_if_parent = 0.0, p_unseen_if_no_parent = 0.0;
    if (!(line >> word >> parent >> p >> p_if_parent >> p_unseen_if_no_parent) || word != model.tree.nodes.size()) return false;
    if (parent < 0) {
      model.tree.nodes.push_back({std::nullopt, p, p, p});
    } else {
      model.tree.nodes.push_back({static_cast<WordId>(parent), p, p_if_parent, 1.0 - p_unseen_if_no_parent});
    }
    return true;
  });
  for_each_line(folder / "bow.csv", [&](std::istringstream& line) {
    int index = 0, num_keypoints = 0;
    std::string name, entry;
    if (!(line >> index >> name >> num_keypoints)) return false;
    Observation& observation = model.observations[index];
    while (line >> entry) observation.words.push_back(static_cast<WordId>(std::stoul(entry)));
    std::sort(observation.words.begin(), observation.words.end());
    return true;
  });
  for_each_line(folder / "gt_pairs.csv", [&](std::istringstream& line) {
    return static_cast<bool>(line >> model.true_pairs.emplace_back().first >> model.true_pairs.back().second);
  });
  return model;
}

}  // namespace fabloop::testing
