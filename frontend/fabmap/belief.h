// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fabloop {

/// Index of a place, in the order in which places were added.
using PlaceId = std::uint32_t;

/// Where the camera is believed to be before its image is looked at. Sums to one.
struct Prior {
  double p_new = 1.0;           ///< At a place that is not in the map.
  std::vector<double> p_place;  ///< At each place of the map.
};

/// Where the camera is believed to be once its image was looked at (Cummins & Newman 2008).
struct Belief {
  double p_new = 1.0;                  ///< At a place that is not in the map. With `p_place` it sums to one (within 1e-12).
  std::vector<double> p_place;         ///< At each place of the map.
  double log_p_new = 0.0;              ///< log p_new, finite where p_new underflows.
  std::vector<double> log_p_place;     ///< log p_place, finite where p_place underflows; minus infinity where the prior was zero.
  double log_likelihood_new = 0.0;     ///< log p(Z | a place that is not in the map).
  std::vector<double> log_likelihood;  ///< log p(Z | each place of the map).
  /// Places, ascending, whose log-likelihood is only an upper bound (LikelihoodEngine::BailOut); empty with other engines.
  std::vector<PlaceId> bailed_out;
};

/// The prior of a camera of which nothing is known: `p_new`, and the rest equally over the places. (With no places, p_new
/// is one.)
Prior uniform_prior(std::size_t num_places, double p_new = 0.5);

/// The prior with the `num_places` most recent places ruled out (they get zero, the rest is scaled to sum to one again).
/// A camera sees the places that it just left, and they would eat the probability of a true revisit.
Prior without_recent_places(Prior prior, std::size_t num_places);

/// The belief given that the camera is at none of the `num_places` most recent places: they get zero, the rest is scaled to sum
/// to one. Where nothing is left, the camera is at a new place. Log-likelihoods stay.
Belief without_recent_places(Belief belief, std::size_t num_places);

/// The belief mixed with total ignorance: `trust` of it, and the rest equally over all places and the new one (after the
/// smoothing of Cummins & Newman 2008; openFABMAP's sFactor is 0.99). Words are not as independent as the model takes them, so a
/// belief is surer of itself than it should be. Log-likelihoods stay. Throws InputError unless `trust` is in [0, 1].
Belief smoothed(Belief belief, double trust);

/// Bayes' rule, in logarithms. `log_likelihood` has one entry for each place of the prior. Throws InputError when the sizes
/// differ or when nothing is possible under prior and likelihood. A `log_likelihood_new` of minus infinity stands for "not at a
/// new place": the belief is then over the places alone.
Belief posterior(const Prior& prior, std::vector<double> log_likelihood, double log_likelihood_new);

}  // namespace fabloop
