// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace fabloop {

/// How false loops are kept from doing harm. Sources in this folder's README.
enum class BackEnd {
  None,                      ///< Every loop is believed.
  Huber,                     ///< M-estimators: a loss on the error of each loop (see RobustLoss).
  Cauchy,                    ///< As Huber.
  GemanMcClure,              ///< As Huber.
  DynamicCovarianceScaling,  ///< Agarwal et al., ICRA 2013: the switch of each loop in closed form.
  SwitchableConstraints,     ///< Suenderhauf & Protzel, IROS 2012: a switch for each loop, sought with the poses.
  GncTruncated,              ///< Graduated non-convexity, truncated least squares (Yang et al., RA-L 2020).
  GncGemanMcClure,           ///< Graduated non-convexity, Geman-McClure (Yang et al., RA-L 2020).
  PairwiseConsistency,       ///< The most loops that fit one another (Mangelson et al., ICRA 2018), then least squares.
};

/// "gnc-truncated", ...: the names of options and tables.
std::string_view to_string(BackEnd back_end);

/// The back end of that name; none for other text.
std::optional<BackEnd> back_end_named(std::string_view name);

/// All of them, in the order of the enumeration.
std::vector<BackEnd> all_back_ends();

}  // namespace fabloop
