// SPDX-License-Identifier: BSD-3-Clause
#include "verification/temporal_consistency.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "frontend/error.h"
#include "verification/chi_square.h"
#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

UncertainPose uncertain_pose_of(const LoopClosure& loop) { return {loop.match_from_query, loop.covariance}; }

std::size_t distance(std::size_t a, std::size_t b) { return a < b ? b - a : a - b; }

}  // namespace

bool loops_agree(const KeyframeMap& map, const LoopClosure& first, const LoopClosure& second, double p_agree,
                 const OdometryStepNoise& odometry) {
  const std::size_t query_session = map.keyframes.back().session;
  const UncertainPose first_match_from_second_match = odometry_between(
      map, position_of(map, first.match_session, first.match), position_of(map, second.match_session, second.match), odometry);
  const UncertainPose first_query_from_second_query = odometry_between(map, position_of(map, query_session, first.query),
                                                                       position_of(map, query_session, second.query), odometry);
  const UncertainPose predicted =
      inverse(first_match_from_second_match) * uncertain_pose_of(first) * first_query_from_second_query;

  const Eigen::Matrix<double, 6, 1> error = pose_error(second.match_from_query, predicted.pose);
  const Eigen::Matrix<double, 6, 6> covariance = second.covariance + predicted.covariance;
  const int num_compared = first.has_scale && second.has_scale ? 6 : 3;
  const Eigen::VectorXd compared = error.tail(num_compared);
  const Eigen::MatrixXd compared_covariance = covariance.bottomRightCorner(num_compared, num_compared);
  const double chi2 = compared.dot(compared_covariance.ldlt().solve(compared));
  return chi2 <= chi_square_quantile(p_agree, num_compared);
}

TemporalConsistency::TemporalConsistency(const ConsistencyOptions& options, const OdometryStepNoise& odometry)
    : options_(options), odometry_(odometry) {
  if (!(options.p_agree > 0.0 && options.p_agree < 1.0)) {
    throw InputError("p_agree of the temporal consistency must lie between 0 and 1: how often two right loops agree");
  }
}

ConfirmedLoops TemporalConsistency::add(const KeyframeMap& map, const std::vector<LoopClosure>& loops) {
  const std::size_t query = map.keyframes.size() - 1;
  const std::size_t reach = options_.num_required * (options_.max_missed + 1);
  forget_before(query - std::min(query, reach));
  std::vector<Candidate> added;
  for (const LoopClosure& loop : loops) added.push_back(linked(map, loop));
  for (Candidate& candidate : added) {
    lengthen_chains_to(candidate);
    candidates_.push_back(std::move(candidate));
  }
  ConfirmedLoops confirmed;
  for (Candidate& candidate : candidates_) {
    if (candidate.is_confirmed || candidate.chain_before + candidate.chain_after < options_.num_required) continue;
    candidate.is_confirmed = true;
    (candidate.query == query ? confirmed.now : confirmed.earlier).push_back(candidate.loop);
  }
  return confirmed;
}

void TemporalConsistency::forget_before(std::size_t query) {
  while (!candidates_.empty() && candidates_.front().query < query) {
    candidates_.pop_front();
    ++num_forgotten_;
  }
}

TemporalConsistency::Candidate TemporalConsistency::linked(const KeyframeMap& map, const LoopClosure& loop) const {
  Candidate result;
  result.loop = loop;
  result.query = map.keyframes.size() - 1;
  result.match = position_of(map, loop.match_session, loop.match);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const Candidate& earlier = candidates_[i];
    const bool is_near = result.query - earlier.query <= options_.max_missed + 1 &&
                         earlier.loop.match_session == loop.match_session &&
                         distance(earlier.match, result.match) <= options_.max_place_gap;
    if (!is_near || !loops_agree(map, earlier.loop, loop, options_.p_agree, odometry_)) continue;
    result.predecessors.push_back(num_forgotten_ + i);
    result.chain_before = std::max(result.chain_before, earlier.chain_before + 1);
  }
  return result;
}

void TemporalConsistency::lengthen_chains_to(const Candidate& last) {
  for (const std::size_t number : last.predecessors) {
    if (number < num_forgotten_) continue;  // too far back to be still unconfirmed
    Candidate& earlier = candidate(number);
    if (earlier.chain_after > last.chain_after) continue;
    earlier.chain_after = last.chain_after + 1;
    lengthen_chains_to(earlier);
  }
}

}  // namespace fabloop
