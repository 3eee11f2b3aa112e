// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust_loss.h"

#include <cmath>

namespace fabloop {

double robust_cost(RobustLoss loss, double chi2, double c2) {
  switch (loss) {
    case RobustLoss::None:
      return chi2;
    case RobustLoss::Huber:
      return chi2 <= c2 ? chi2 : 2.0 * std::sqrt(c2 * chi2) - c2;
    case RobustLoss::Cauchy:
      return c2 * std::log1p(chi2 / c2);
    case RobustLoss::GemanMcClure:
      return c2 * chi2 / (c2 + chi2);
    case RobustLoss::DynamicCovarianceScaling:
      return chi2 <= c2 ? chi2 : c2 * (3.0 * chi2 - c2) / (c2 + chi2);
  }
  return chi2;
}

double robust_weight(RobustLoss loss, double chi2, double c2) {
  switch (loss) {
    case RobustLoss::None:
      return 1.0;
    case RobustLoss::Huber:
      return chi2 <= c2 ? 1.0 : std::sqrt(c2 / chi2);
    case RobustLoss::Cauchy:
      return c2 / (c2 + chi2);
    case RobustLoss::GemanMcClure:
      return (c2 / (c2 + chi2)) * (c2 / (c2 + chi2));
    case RobustLoss::DynamicCovarianceScaling:
      return chi2 <= c2 ? 1.0 : (2.0 * c2 / (c2 + chi2)) * (2.0 * c2 / (c2 + chi2));
  }
  return 1.0;
}

double robust_curvature(RobustLoss loss, double chi2, double c2) {
  switch (loss) {
    case RobustLoss::None:
      return 0.0;
    case RobustLoss::Huber:
      return chi2 <= c2 ? 0.0 : -0.5 * std::sqrt(c2 / chi2) / chi2;
    case RobustLoss::Cauchy:
      return -c2 / ((c2 + chi2) * (c2 + chi2));
    case RobustLoss::GemanMcClure:
      return -2.0 * c2 * c2 / ((c2 + chi2) * (c2 + chi2) * (c2 + chi2));
    case RobustLoss::DynamicCovarianceScaling:
      return chi2 <= c2 ? 0.0 : -8.0 * c2 * c2 / ((c2 + chi2) * (c2 + chi2) * (c2 + chi2));
  }
  return 0.0;
}

}  // namespace fabloop
