// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/motion_model.h"

#include <string>
#include <vector>

#include "frontend/error.h"

namespace fabloop {
namespace {

bool is_probability(double p) { return p >= 0.0 && p <= 1.0; }

void validate(const MotionModel& motion) {
  if (is_probability(motion.p_new) && is_probability(motion.p_teleport) && is_probability(motion.p_forward)) return;
  throw InputError("the motion model's p_new, p_teleport and p_forward must lie in [0, 1]");
}

/// Where the last image was, over the places there are now. None of it where the last image was new and was not added.
std::vector<double> last_place(const Belief& previous, std::size_t num_places) {
  if (num_places < previous.p_place.size() || num_places > previous.p_place.size() + 1) {
    throw InputError("the previous belief is over " + std::to_string(previous.p_place.size()) + " places and the map has " +
                     std::to_string(num_places) + "; predict after every image");
  }
  std::vector<double> result = previous.p_place;
  if (num_places > result.size()) result.push_back(previous.p_new);
  return result;
}

/// Probability of moving by each of 1 ... reach places in the two directions, and of staying.
struct Moves {
  double stay;
  double forward;
  double backward;
};

Moves moves(const MotionModel& motion) {
  const auto reach = static_cast<double>(motion.reach);
  const double stay = 1.0 / (2.0 * reach + 1.0);
  if (motion.reach == 0) return {stay, 0.0, 0.0};
  return {stay, (1.0 - stay) * motion.p_forward / reach, (1.0 - stay) * (1.0 - motion.p_forward) / reach};
}

}  // namespace

Prior predict(const MotionModel& motion, const Belief& previous, std::size_t num_places) {
  validate(motion);
  const std::vector<double> last = last_place(previous, num_places);
  if (num_places == 0) return {1.0, {}};
  double p_on_map = 0.0;
  for (const double p : last) p_on_map += p;
  // What is known of the last place steers the next one; what is not known is as a teleport.
  const double p_moved = (1.0 - motion.p_new) * (1.0 - motion.p_teleport);
  const double p_anywhere = (1.0 - motion.p_new) - p_moved * p_on_map;
  Prior prior = {motion.p_new, std::vector<double>(num_places, p_anywhere / static_cast<double>(num_places))};
  const Moves step = moves(motion);
  const auto arrive = [&](std::ptrdiff_t place, double p) {
    const bool leaves_route = place < 0 || place >= static_cast<std::ptrdiff_t>(num_places);
    (leaves_route ? prior.p_new : prior.p_place[static_cast<std::size_t>(place)]) += p;
  };
  for (std::size_t i = 0; i < num_places; ++i) {
    const double p = p_moved * last[i];
    if (p == 0.0) continue;
    const auto from = static_cast<std::ptrdiff_t>(i);
    arrive(from, p * step.stay);
    for (std::ptrdiff_t move = 1; move <= static_cast<std::ptrdiff_t>(motion.reach); ++move) {
      arrive(from + move, p * step.forward);
      arrive(from - move, p * step.backward);
    }
  }
  double sum = prior.p_new;
  for (const double p : prior.p_place) sum += p;
  prior.p_new /= sum;
  for (double& p : prior.p_place) p /= sum;
  return prior;
}

}  // namespace fabloop
