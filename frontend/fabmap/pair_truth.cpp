// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/pair_truth.h"

#include <algorithm>
#include <sstream>

#include "frontend/csv_lines.h"

namespace fabloop {

MatchTruth judge_pair(const PairTruth& pair, const PairRules& rules) {
  if (pair.overlap >= rules.min_true_overlap || pair.num_inliers >= rules.min_true_inliers) return MatchTruth::True;
  return pair.overlap < rules.max_false_overlap ? MatchTruth::False : MatchTruth::NotJudged;
}

PairTruth pair_between(const PairTruths& pairs, std::size_t a, std::size_t b) {
  const auto found = pairs.find(std::minmax(a, b));
  return found == pairs.end() ? PairTruth{} : found->second;
}

std::string in_words(const PairRules& rules) {
  std::ostringstream text;
  text << "a pair is true with overlap >= " << rules.min_true_overlap << " or >= " << rules.min_true_inliers
       << " inliers, false with overlap < " << rules.max_false_overlap << " and fewer inliers, else not judged";
  return text.str();
}

PairTruths read_pairs(const std::filesystem::path& path) {
  PairTruths pairs;
  for_each_csv_line(path, [&](const CsvFields& fields, const CsvFail& fail) {
    if (fields.size() < 4) fail("has fewer than 4 columns; a line is 'i,j,distance,overlap,inliers'");
    const std::size_t a = parse_position(fields[0], fail);
    const std::size_t b = parse_position(fields[1], fail);
    PairTruth truth;
    if (!fields[3].empty()) truth.overlap = parse_number(fields[3], fail);
    if (fields.size() > 4 && !fields[4].empty()) truth.num_inliers = parse_position(fields[4], fail);
    pairs[{std::min(a, b), std::max(a, b)}] = truth;
  });
  return pairs;
}

}  // namespace fabloop
