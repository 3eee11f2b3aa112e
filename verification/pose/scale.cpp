// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/scale.h"

#include <algorithm>
#include <cmath>

#include "verification/median.h"
#include "verification/pose/residuals.h"

namespace fabloop {
namespace {

/// Points whose errors are as good as independent: the surface that two neighbours triangulate tilts as a whole.
constexpr double kPointsPerError = 5.0;
constexpr double kWrongShare = 0.2;     ///< Of points, a priori.
constexpr double kWrongRange = 4.0;     ///< Logarithms of depth ratios of wrong points spread about as far.
constexpr double kTypicalError = 0.05;  ///< Relative, of a right point's depth.

/// One known depth against the one that the rays tell.
struct DepthRatio {
  double log_baseline = 0;
  double depth_from_match = 0;
};

std::vector<DepthRatio> depth_ratios(const View& query, const View& match, const std::vector<Match>& matches,
                                     const Pose& match_from_query, double min_parallax_rad) {
  std::vector<DepthRatio> ratios;
  for (const Match& m : matches) {
    const auto q = static_cast<std::size_t>(m.query);
    const auto k = static_cast<std::size_t>(m.match);
    const RayDepths depths = ray_depths(match_from_query.rotation * query.rays[q], match.rays[k], match_from_query.translation);
    if (depths.squared_sine < min_parallax_rad * min_parallax_rad || depths.query <= 0 || depths.match <= 0) continue;
    const double from_match = depths.match / depths.squared_sine;
    const auto add = [&](double known, double per_baseline) {
      ratios.push_back({std::log(known / per_baseline), known / per_baseline * from_match});
    };
    if (query.points_in_camera[q]) add(query.points_in_camera[q]->norm(), depths.query / depths.squared_sine);
    if (match.points_in_camera[k]) add(match.points_in_camera[k]->norm(), from_match);
  }
  return ratios;
}

double log_likelihood(const std::vector<DepthRatio>& ratios, double log_baseline) {
  double sum = 0;
  for (const DepthRatio& ratio : ratios) {
    const double right = std::exp(-std::abs(ratio.log_baseline - log_baseline) / kTypicalError) / (2.0 * kTypicalError);
    sum += std::log(kWrongRange * ((1.0 - kWrongShare) * right + kWrongShare / kWrongRange));
  }
  return sum / kPointsPerError;
}

}  // namespace

std::optional<Scale> estimate_scale(const View& query, const View& match, const std::vector<Match>& matches,
                                    const Pose& match_from_query, const ScaleOptions& options) {
  const auto ratios = depth_ratios(query, match, matches, match_from_query, options.min_parallax_rad);
  if (static_cast<int>(ratios.size()) < options.min_points) return std::nullopt;
  std::vector<double> logs;
  for (const DepthRatio& ratio : ratios) logs.push_back(ratio.log_baseline);
  double centre = median(logs);
  std::vector<double> agreeing, depths;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    agreeing.clear();
    depths.clear();
    for (const DepthRatio& ratio : ratios) {
      if (std::abs(ratio.log_baseline - centre) > options.max_relative_error) continue;
      agreeing.push_back(ratio.log_baseline);
      depths.push_back(ratio.depth_from_match);
    }
    if (agreeing.empty()) break;
    centre = median(agreeing);
  }
  Scale scale;
  scale.baseline = std::exp(centre);
  scale.num_points = static_cast<int>(agreeing.size());
  scale.share = static_cast<double>(agreeing.size()) / static_cast<double>(ratios.size());
  scale.median_depth = median(depths);
  scale.log_likelihood = log_likelihood(ratios, centre);
  scale.agrees = scale.num_points >= options.min_points && scale.share >= options.min_share;
  double sum_of_squares = 0;
  for (const double value : agreeing) sum_of_squares += (value - centre) * (value - centre);
  const double variance = sum_of_squares / std::max(1.0, static_cast<double>(agreeing.size()) - 1.0);
  scale.relative_sigma = std::sqrt(variance * kPointsPerError / std::max(1.0, static_cast<double>(agreeing.size())));
  return scale;
}

}  // namespace fabloop
