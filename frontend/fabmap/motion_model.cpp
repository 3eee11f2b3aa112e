// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/motion_model.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "frontend/error.h"

namespace fabloop {
namespace {

bool is_probability(double p) { return p >= 0.0 && p <= 1.0; }

void validate(const MotionModel& motion) {
  if (is_probability(motion.p_new) && is_probability(motion.p_teleport) && is_probability(motion.p_forward)) return;
  throw InputError("the motion model's p_new, p_teleport and p_forward must lie in [0, 1]");
}

void validate(const PlaceGraph& graph) {
  for (const std::vector<PlaceId>& next : graph.next) {
    for (const PlaceId to : next) {
      if (to < graph.num_places()) continue;
      throw InputError("a link of the place graph ends at place " + std::to_string(to) + " but there are only " +
                       std::to_string(graph.num_places()) + " places");
    }
  }
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

/// The links of a route, without a list of them.
struct RouteLinks {
  std::size_t num_places;

  void forward(const std::vector<double>& from, std::vector<double>& to) const {
    for (std::size_t i = 1; i < num_places; ++i) to[i] = from[i - 1];
  }
  void backward(const std::vector<double>& from, std::vector<double>& to) const {
    for (std::size_t i = 1; i < num_places; ++i) to[i - 1] = from[i];
  }
};

/// The links of a graph, followed and gone back.
class GraphLinks {
 public:
  explicit GraphLinks(const PlaceGraph& graph) : graph_(graph), num_ways_back_(graph.num_places(), 0) {
    for (const std::vector<PlaceId>& next : graph.next) {
      for (const PlaceId to : next) ++num_ways_back_[to];
    }
  }
  void forward(const std::vector<double>& from, std::vector<double>& to) const {
    for (std::size_t i = 0; i < from.size(); ++i) {
      for (const PlaceId next : graph_.next[i]) to[next] += from[i] / static_cast<double>(graph_.next[i].size());
    }
  }
  void backward(const std::vector<double>& from, std::vector<double>& to) const {
    for (std::size_t i = 0; i < from.size(); ++i) {
      for (const PlaceId next : graph_.next[i]) to[i] += from[next] / static_cast<double>(num_ways_back_[next]);
    }
  }

 private:
  const PlaceGraph& graph_;
  std::vector<std::size_t> num_ways_back_;  ///< By place: the links that lead there.
};

double sum_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum;
}

/// Adds `weight` times what moves of 1 ... reach places lead to; what finds no link on the way is at a new place.
template <typename Step>
void add_moves(std::vector<double> at, std::size_t reach, double weight, const Step& step, Prior& prior) {
  if (weight == 0.0) return;
  const double p_started = sum_of(at);
  for (std::size_t move = 1; move <= reach; ++move) {
    std::vector<double> next(at.size(), 0.0);
    step(at, next);
    at = std::move(next);
    for (std::size_t i = 0; i < at.size(); ++i) prior.p_place[i] += weight * at[i];
    prior.p_new += weight * std::max(0.0, p_started - sum_of(at));
  }
}

template <typename Links>
Prior predict_by(const MotionModel& motion, const Belief& previous, std::size_t num_places, const Links& links) {
  validate(motion);
  std::vector<double> last = last_place(previous, num_places);
  if (num_places == 0) return {1.0, {}};
  // What is known of the last place steers the next one; what is not known is as a teleport.
  const double p_moved = (1.0 - motion.p_new) * (1.0 - motion.p_teleport);
  for (double& p : last) p *= p_moved;
  const double p_anywhere = (1.0 - motion.p_new) - sum_of(last);
  Prior prior = {motion.p_new, std::vector<double>(num_places, p_anywhere / static_cast<double>(num_places))};
  const Moves step = moves(motion);
  for (std::size_t i = 0; i < num_places; ++i) prior.p_place[i] += step.stay * last[i];
  add_moves(
      last, motion.reach, step.forward, [&](const auto& from, auto& to) { links.forward(from, to); }, prior);
  add_moves(
      last, motion.reach, step.backward, [&](const auto& from, auto& to) { links.backward(from, to); }, prior);
  const double sum = prior.p_new + sum_of(prior.p_place);
  prior.p_new /= sum;
  for (double& p : prior.p_place) p /= sum;
  return prior;
}

}  // namespace

Prior predict(const MotionModel& motion, const Belief& previous, std::size_t num_places) {
  return predict_by(motion, previous, num_places, RouteLinks{num_places});
}

Prior predict(const MotionModel& motion, const Belief& previous, const PlaceGraph& graph) {
  validate(graph);
  return predict_by(motion, previous, graph.num_places(), GraphLinks(graph));
}

}  // namespace fabloop
