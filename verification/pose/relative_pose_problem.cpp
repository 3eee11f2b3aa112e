// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/relative_pose_problem.h"

#include <algorithm>
#include <cmath>
#include <opengv/relative_pose/CentralRelativeAdapter.hpp>
#include <opengv/relative_pose/methods.hpp>

#include "verification/pose/essential_poses.h"
#include "verification/pose/residuals.h"

namespace fabloop {

RelativePoseProblem::RelativePoseProblem(std::span<const RayPair> pairs, const RelativePoseOptions& options)
    : pairs_(pairs), options_(options), data_(pairs.size()), equations_(equations_of(pairs)) {
  for (std::size_t i = 0; i < pairs.size(); ++i) data_.set(i, pairs[i].query.data(), pairs[i].match.data());
}

std::optional<Pose> RelativePoseProblem::model_of(const Essential& essential) const {
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> matrix(essential.data());
  return most_in_front(essential_poses(matrix));
}

Pose RelativePoseProblem::refine(const Pose& match_from_query, const std::vector<std::size_t>& inliers) const {
  constexpr int kLocalSteps = 5;
  const Pose refined = minimise(equations_of(pairs_, inliers), match_from_query, kLocalSteps);
  if (2 * num_in_front(refined) > inliers.size()) return refined;
  // A poor start may have had the right essential matrix nearby, but another of its poses in front of the cameras.
  return most_in_front(essential_poses(essential_matrix(refined))).value_or(refined);
}

std::size_t RelativePoseProblem::num_in_front(const Pose& match_from_query) const {
  const std::vector<double> angles = equations_.angles(frame_of(match_from_query), options_.max_error_rad);
  return static_cast<std::size_t>(
      std::count_if(angles.begin(), angles.end(), [&](double angle) { return std::abs(angle) < options_.max_error_rad; }));
}

std::optional<Pose> RelativePoseProblem::most_in_front(const std::array<Pose, 4>& poses) const {
  std::array<std::size_t, 4> in_front{};
  for (std::size_t k = 0; k < poses.size(); ++k) in_front[k] = num_in_front(poses[k]);
  const auto most = std::max_element(in_front.begin(), in_front.end());
  if (*most < kSampleSize) return std::nullopt;
  return poses[static_cast<std::size_t>(most - in_front.begin())];
}

std::vector<Essential> RelativePoseProblem::solve_in_lanes(const Samples& samples) const {
  FivePointSamples rays;
  for (std::size_t lane = 0; lane < kBatchSize; ++lane) {
    for (std::size_t i = 0; i < kSampleSize; ++i) {
      const RayPair& pair = pairs_[samples[lane][i]];
      for (Eigen::Index k = 0; k < 3; ++k) {
        rays.query[i][static_cast<std::size_t>(k)][lane] = pair.query(k);
        rays.match[i][static_cast<std::size_t>(k)][lane] = pair.match(k);
      }
    }
  }
  const FivePointSolutions solutions = five_point(rays);
  std::vector<Essential> essentials;
  essentials.reserve(kBatchSize * kMaxFivePointSolutions);
  for (std::size_t lane = 0; lane < kBatchSize; ++lane) {
    const auto& found = solutions.essentials[lane];
    essentials.insert(essentials.end(), found.begin(), found.begin() + static_cast<std::ptrdiff_t>(solutions.count[lane]));
  }
  return essentials;
}

std::vector<Essential> RelativePoseProblem::solve_by_opengv(const Samples& samples) const {
  std::vector<Essential> essentials;
  for (const auto& sample : samples) {
    opengv::bearingVectors_t match_rays, query_rays;
    for (const std::size_t i : sample) {
      match_rays.push_back(pairs_[i].match);
      query_rays.push_back(pairs_[i].query);
    }
    opengv::relative_pose::CentralRelativeAdapter adapter(match_rays, query_rays);
    // OpenGV's essential matrices satisfy match^T E query = 0.
    for (const auto& essential : opengv::relative_pose::fivept_nister(adapter)) {
      if (!essential.allFinite()) continue;
      Essential rows;
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data()) = essential;
      essentials.push_back(rows);
    }
  }
  return essentials;
}

}  // namespace fabloop
