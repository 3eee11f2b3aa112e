// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/detector_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "frontend/error.h"

namespace fabloop {

double p_seen_given_present(const DetectorModel& detector, bool seen, bool present) {
  const double p_seen = present ? detector.p_seen_if_present : detector.p_seen_if_absent;
  return seen ? p_seen : 1.0 - p_seen;
}

double p_present_anywhere(const DetectorModel& detector, double p_word) {
  // p(z) = p(z|e) p(e) + p(z|not e) (1 - p(e)), solved for p(e). Words rarer than false detections are still somewhere.
  const double p = (p_word - detector.p_seen_if_absent) / (detector.p_seen_if_present - detector.p_seen_if_absent);
  return std::clamp(p, std::min(p_word, 1.0 - kMaxPresentAnywhere), kMaxPresentAnywhere);
}

double presence_factor(const DetectorModel& detector, std::uint32_t visits, std::uint32_t detections) {
  assert(detections <= visits);
  constexpr double kLeastLog = -650.0;
  if (detections > 0 && detector.p_seen_if_absent == 0.0) return std::numeric_limits<double>::infinity();
  const double misses = visits - detections;
  double log_factor = misses * std::log((1.0 - detector.p_seen_if_present) / (1.0 - detector.p_seen_if_absent));
  if (detections > 0) log_factor += detections * std::log(detector.p_seen_if_present / detector.p_seen_if_absent);
  return std::exp(std::max(log_factor, kLeastLog));
}

double p_present(const DetectorModel& detector, double p_word, std::uint32_t visits, std::uint32_t detections) {
  const double p_anywhere = p_present_anywhere(detector, p_word);
  const double odds = p_anywhere / (1.0 - p_anywhere) * presence_factor(detector, visits, detections);
  return 1.0 / (1.0 + 1.0 / odds);
}

void validate(const DetectorModel& detector, const std::string& where) {
  if (!(detector.p_seen_if_absent >= 0.0 && detector.p_seen_if_absent < detector.p_seen_if_present &&
        detector.p_seen_if_present < 1.0)) {
    throw InputError(where + ": the detector model needs 0 <= p_seen_if_absent < p_seen_if_present < 1, but they are " +
                     std::to_string(detector.p_seen_if_absent) + " and " + std::to_string(detector.p_seen_if_present));
  }
}

}  // namespace fabloop
