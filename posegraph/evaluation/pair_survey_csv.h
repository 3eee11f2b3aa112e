// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "frontend/sequence/sequence.h"
#include "posegraph/evaluation/loop_evaluation.h"
#include "posegraph/evaluation/loop_truth.h"
#include "posegraph/evaluation/pair_survey.h"

namespace fabloop {

/// Throws InputError when two sequences have one name, so that a file of pairs could not tell them apart.
void require_distinct_names(const std::vector<Sequence>& sequences);

/// Every pair on a line: sequences by name, frames by position, all figures of the verdict, and how far the pose is off (empty
/// where there is no pose or no reference). `truths` and `evaluations` by sequence. Throws InputError when the file cannot be
/// written.
void write_surveyed_pairs(const std::filesystem::path& path, const std::vector<SurveyedPair>& pairs,
                          const std::vector<Sequence>& sequences, const std::vector<LoopTruth>& truths,
                          const std::vector<LoopEvaluationOptions>& evaluations);

/// The pairs of such a file, of which the first four columns are read, in any order of the sequences. Throws InputError, with
/// file and line, for a sequence that is not among these, a frame that it does not have, and a frame with itself.
std::vector<AskedPair> read_asked_pairs(const std::filesystem::path& path, const std::vector<Sequence>& sequences);

}  // namespace fabloop
