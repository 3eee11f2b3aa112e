// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace fabloop {

/// How reliably a word is seen (Cummins & Newman 2008). The element e_q is what is really there, the word z_q what
/// the detector reports.
struct DetectorModel {
  double p_seen_if_present = 0.39;  ///< p(z=1|e=1). Raise it for detectors that repeat better, or for views that differ little.
  double p_seen_if_absent = 0.0;    ///< p(z=1|e=0). Raise it when one wrong word should not speak against a place for good.
};

/// Nothing is everywhere for certain, or no number of visits could tell otherwise.
inline constexpr double kMaxPresentAnywhere = 0.999;

/// p(z = `seen` | e = `present`).
double p_seen_given_present(const DetectorModel& detector, bool seen, bool present);

/// p(e=1) at a place never visited, for a word with marginal probability p(z=1) = `p_word`: the one that gives p(z=1) back,
/// at most kMaxPresentAnywhere for words that are seen more often than the detector could see them if always present.
double p_present_anywhere(const DetectorModel& detector, double p_word);

/// What visits do to the odds of e at a place: odds after them over odds before. Infinite where a detection is certainty. Not
/// below exp(-650), so that no number of visits makes a word impossible.
double presence_factor(const DetectorModel& detector, std::uint32_t visits, std::uint32_t detections);

/// p(e=1 | L) once the place was visited `visits` times and the word was seen at `detections` of them (Cummins & Newman
/// 2008, their recursion applied to every visit: only the two counts matter).
double p_present(const DetectorModel& detector, double p_word, std::uint32_t visits, std::uint32_t detections);

/// Throws InputError naming `where` unless 0 <= p_seen_if_absent < p_seen_if_present < 1.
void validate(const DetectorModel& detector, const std::string& where);

}  // namespace fabloop
