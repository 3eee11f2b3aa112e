// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/evaluation/pair_survey_csv.h"

#include <fstream>
#include <set>
#include <string>
#include <utility>

#include "frontend/csv_lines.h"
#include "frontend/error.h"

namespace fabloop {
namespace {

constexpr const char* kColumns =
    "query_sequence,query,match_sequence,match,verdict,judgement,rotation_error_deg,translation_error_m,direction_error_deg,p_"
    "true,"
    "matches,inliers,num_true,log10_false_alarms,inlier_area,parallax_deg,rotation_sigma_deg,translation_sigma,point_inliers,"
    "has_scale,iterations,tx,ty,tz,qx,qy,qz,qw";

void write_judgement(std::ostream& out, const SurveyedPair& pair, const JudgedLoop& judged) {
  const Verdict verdict = pair.verification.verdict;
  const bool has_pose = verdict != Verdict::TooFewMatches && verdict != Verdict::NoPose;
  if (has_pose) out << in_words(judged.judgement);
  out << ',';
  const bool has_reference = pair.query.sequence == pair.match.sequence && judged.judgement != LoopJudgement::NoReference;
  if (!has_pose || !has_reference) {
    out << ",,,";
    return;
  }
  out << judged.rotation_error_deg << ',';
  if (pair.verification.has_scale) out << judged.translation_error_m;
  out << ',';
  if (!pair.verification.has_scale) out << judged.direction_error_deg;
  out << ',';
}

SurveyedFrame parse_frame(const std::string& sequence, const std::string& frame, const std::vector<Sequence>& sequences,
                          const CsvFail& fail) {
  const std::size_t position = parse_position(frame, fail);
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    if (sequences[s].name != sequence) continue;
    if (position >= sequences[s].frames.size()) {
      fail("sequence " + sequence + " has no frame " + frame + ", only 0 to " + std::to_string(sequences[s].frames.size() - 1));
    }
    return {s, position};
  }
  fail("no sequence \"" + sequence + "\" is surveyed: name its folder on the command line");
  return {};
}

}  // namespace

void require_distinct_names(const std::vector<Sequence>& sequences) {
  std::set<std::string> names;
  for (const Sequence& sequence : sequences) {
    if (!names.insert(sequence.name).second) {
      throw InputError("two sequences are called \"" + sequence.name +
                       "\", and a file of pairs tells them by their names: give one folder another name");
    }
  }
}

void write_surveyed_pairs(const std::filesystem::path& path, const std::vector<SurveyedPair>& pairs,
                          const std::vector<Sequence>& sequences, const std::vector<LoopTruth>& truths,
                          const std::vector<LoopEvaluationOptions>& evaluations) {
  std::ofstream file(path);
  file << kColumns << '\n';
  for (const SurveyedPair& pair : pairs) {
    const Verification& v = pair.verification;
    const Eigen::Quaterniond& q = v.match_from_query.rotation;
    const Eigen::Vector3d& t = v.match_from_query.translation;
    file << sequences[pair.query.sequence].name << ',' << pair.query.frame << ',' << sequences[pair.match.sequence].name << ','
         << pair.match.frame << ',' << to_string(v.verdict) << ',';
    write_judgement(file, pair, judge_pair(pair, truths, evaluations));
    file << v.p_true << ',' << v.num_matches << ',' << v.num_inliers << ',' << v.num_true << ',' << v.log10_false_alarms << ','
         << v.inlier_area << ',' << v.median_parallax_deg << ',' << v.rotation_sigma_deg << ',' << v.translation_sigma << ','
         << v.num_point_inliers << ',' << v.has_scale << ',' << v.num_iterations << ',' << t.x() << ',' << t.y() << ',' << t.z()
         << ',' << q.x() << ',' << q.y() << ',' << q.z() << ',' << q.w() << '\n';
  }
  if (!file.flush()) throw InputError(path.string() + ": could not be written");
}

std::vector<AskedPair> read_asked_pairs(const std::filesystem::path& path, const std::vector<Sequence>& sequences) {
  require_distinct_names(sequences);
  std::vector<AskedPair> pairs;
  for_each_csv_line(path, [&](const CsvFields& fields, const CsvFail& fail) {
    if (!fields.empty() && fields[0] == "query_sequence") return;
    if (fields.size() < 4) fail("a pair takes four columns: query_sequence,query,match_sequence,match");
    AskedPair pair{parse_frame(fields[0], fields[1], sequences, fail), parse_frame(fields[2], fields[3], sequences, fail)};
    if (pair.query == pair.match) fail("a frame with itself");
    if (pair.query < pair.match) std::swap(pair.query, pair.match);
    pairs.push_back(pair);
  });
  return pairs;
}

}  // namespace fabloop
