// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace fabloop {

/// What images of the kind that a model was trained on look like to it; see DomainCheck. Kept in the model file.
struct Domain {
  /// Of training images that were held out, judged by the others: 0, 1, ..., 100 % quantiles, ascending.
  std::vector<double> familiarity;              ///< See Familiarity.
  std::vector<double> log_likelihood_per_word;  ///< log p(Z) under the tree over the number of words seen, nats.
};

/// As it stands in a model file.
std::string to_json(const Domain& domain);

/// The inverse. Throws InputError when something is missing, no number or in no order.
Domain domain_from_json(const std::string& json);

}  // namespace fabloop
