// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/loop_consistency.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "verification/chi_square.h"
#include "verification/uncertain_pose.h"

namespace fabloop {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

}  // namespace

LoopConsistency::LoopConsistency(const PoseGraph& graph, const std::vector<EdgeKind>& doubted, double probability,
                                 double noise_scale)
    : dimension_(graph.dimension),
      odometry_(graph, doubted),
      threshold_(noise_scale * chi_square_quantile(probability, dimension_ == 2 ? 3 : 6)),
      threshold_of_rotation_(noise_scale * chi_square_quantile(probability, dimension_ == 2 ? 1 : 3)) {
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const Edge& edge = graph.edges[e];
    if (std::find(doubted.begin(), doubted.end(), edge.kind) == doubted.end()) continue;
    edges_.push_back(e);
    loops_.push_back(make_loop(edge));
  }
  by_start_.resize(loops_.size());
  std::iota(by_start_.begin(), by_start_.end(), std::size_t{0});
  std::stable_sort(by_start_.begin(), by_start_.end(), [&](std::size_t a, std::size_t b) {
    return odometry_.depth(loops_[a].from) < odometry_.depth(loops_[b].from);
  });
  place_by_start_.resize(loops_.size());
  for (std::size_t place = 0; place < by_start_.size(); ++place) place_by_start_[by_start_[place]] = place;
}

LoopConsistency::Loop LoopConsistency::make_loop(Edge edge) const {
  Matrix6d covariance = edge_covariance(edge, dimension_);
  const bool is_turned = edge.from > edge.to;
  if (is_turned) {
    const Matrix6d from_from_to = adjoint(edge.from_from_to);
    covariance = from_from_to * covariance * from_from_to.transpose();
    edge.from_from_to = edge.from_from_to.inverse();
    std::swap(edge.from, edge.to);
  }
  Loop loop{edge.from, edge.to, edge.has_scale, is_turned, edge.from_from_to, {}, covariance, {}, 0.0};
  loop.to_from_root_by_loop = (odometry_.root_from_vertex(edge.from) * edge.from_from_to).inverse();
  const Matrix6d root_from_to = adjoint(odometry_.root_from_vertex(edge.to));
  loop.covariance_in_root = root_from_to * loop.covariance * root_from_to.transpose();
  loop.rotation_variance = loop.covariance.bottomRightCorner<3, 3>().trace();
  return loop;
}

double LoopConsistency::mahalanobis(const Matrix6d& covariance, const Pose& error, bool has_scale) const {
  const Eigen::Matrix<double, 6, 1> e = pose_error({}, error);
  const Eigen::Vector3d rotation = e.tail<3>();
  if (dimension_ == 2) {
    const double yaw = rotation.z();
    if (!has_scale) return yaw * yaw / covariance(5, 5);
    constexpr std::array<int, 3> kRows = {0, 1, 5};
    Eigen::Matrix3d planar;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) planar(row, column) = covariance(kRows[row], kRows[column]);
    }
    const Eigen::Vector3d planar_error(e(0), e(1), yaw);
    return planar_error.dot(planar.llt().solve(planar_error));
  }
  if (!has_scale) return rotation.dot(covariance.bottomRightCorner<3, 3>().llt().solve(rotation));
  return e.dot(covariance.llt().solve(e));
}

double LoopConsistency::chi2(std::size_t a, std::size_t b) const {
  const Loop& first = loops_[a];
  const Loop& second = loops_[b];
  if (!odometry_.joins(first.from, second.from) || !odometry_.joins(first.to, second.to)) return 0.0;
  // k_from_i * i_from_j * j_from_l * l_from_k for the loops (i, k) and (j, l).
  const Pose& root_from_k = odometry_.root_from_vertex(first.to);
  const Pose k_from_l_by_loops = first.to_from_root_by_loop * (odometry_.root_from_vertex(second.from) * second.from_from_to);
  const Pose l_from_k = odometry_.root_from_vertex(second.to).inverse() * root_from_k;
  const Pose error = k_from_l_by_loops * l_from_k;
  const Matrix6d starts = odometry_.covariance_in_root(first.from, second.from);
  const Matrix6d ends = odometry_.covariance_in_root(first.to, second.to);
  // No rotation error is likelier than along the largest axis, which is at most the trace.
  const double rotation_variance = first.rotation_variance + second.rotation_variance + starts.bottomRightCorner<3, 3>().trace() +
                                   ends.bottomRightCorner<3, 3>().trace();
  const double angle = rotation_angle(error.rotation);
  if (angle * angle > std::max(threshold_, threshold_of_rotation_) * rotation_variance) return kUnlimited;
  const Matrix6d by_loop = adjoint(first.to_from_root_by_loop);
  const Matrix6d by_odometry = adjoint(root_from_k.inverse());
  const Matrix6d covariance = first.covariance + by_loop * starts * by_loop.transpose() +
                              by_odometry * (second.covariance_in_root + ends) * by_odometry.transpose();
  return mahalanobis(covariance, error, first.has_scale && second.has_scale);
}

int LoopConsistency::degrees_of_freedom(std::size_t a, std::size_t b) const {
  const bool has_scale = loops_[a].has_scale && loops_[b].has_scale;
  return dimension_ == 2 ? (has_scale ? 3 : 1) : (has_scale ? 6 : 3);
}

bool LoopConsistency::are_consistent(std::size_t a, std::size_t b) const {
  return chi2(a, b) <= (loops_[a].has_scale && loops_[b].has_scale ? threshold_ : threshold_of_rotation_);
}

double LoopConsistency::chi2_of_odometry(std::size_t a) const {
  const Loop& loop = loops_[a];
  if (!odometry_.joins(loop.from, loop.to)) return 0.0;
  const Pose error = loop.to_from_root_by_loop * odometry_.root_from_vertex(loop.to);
  const Matrix6d to_from_root = adjoint(odometry_.root_from_vertex(loop.to).inverse());
  const Matrix6d covariance =
      loop.covariance + to_from_root * odometry_.covariance_in_root(loop.from, loop.to) * to_from_root.transpose();
  return mahalanobis(covariance, error, loop.has_scale);
}

double LoopConsistency::contradiction(std::size_t a, const UncertainPose& from_from_to) const {
  const Loop& loop = loops_[a];
  const UncertainPose other = loop.is_turned ? inverse(from_from_to) : from_from_to;
  const Pose error = loop.from_from_to.inverse() * other.pose;
  return mahalanobis(loop.covariance + other.covariance, error, loop.has_scale) /
         (loop.has_scale ? threshold_ : threshold_of_rotation_);
}

std::vector<std::size_t> LoopConsistency::nearest(std::size_t a, std::size_t count, std::size_t max_steps) const {
  const Loop& loop = loops_[a];
  // Largest first, so that the first is the one to be replaced.
  std::vector<std::pair<std::size_t, std::size_t>> heap;
  const auto steps_between = [](std::size_t depth_a, std::size_t depth_b) {
    return depth_a > depth_b ? depth_a - depth_b : depth_b - depth_a;
  };
  const auto consider = [&](std::size_t b) {
    const Loop& other = loops_[b];
    if (!odometry_.joins(loop.from, other.from) || !odometry_.joins(loop.to, other.to)) return;
    // Depths differ by no more than there are steps.
    const std::size_t at_least = steps_between(odometry_.depth(loop.from), odometry_.depth(other.from)) +
                                 steps_between(odometry_.depth(loop.to), odometry_.depth(other.to));
    if (at_least > max_steps || (heap.size() == count && at_least >= heap.front().first)) return;
    const std::size_t steps = odometry_.num_steps(loop.from, other.from) + odometry_.num_steps(loop.to, other.to);
    if (steps > max_steps) return;
    heap.emplace_back(steps, b);
    std::push_heap(heap.begin(), heap.end());
    if (heap.size() <= count) return;
    std::pop_heap(heap.begin(), heap.end());
    heap.pop_back();
  };
  const auto is_too_far = [&](std::size_t b) {
    const std::size_t at_least = steps_between(odometry_.depth(loop.from), odometry_.depth(loops_[b].from));
    return at_least > max_steps || (heap.size() == count && at_least >= heap.front().first);
  };
  const std::size_t place = place_by_start_[a];
  for (std::size_t k = place; k-- > 0 && !is_too_far(by_start_[k]);) consider(by_start_[k]);
  for (std::size_t k = place + 1; k < by_start_.size() && !is_too_far(by_start_[k]); ++k) consider(by_start_[k]);
  std::sort_heap(heap.begin(), heap.end());
  std::vector<std::size_t> result;
  for (const auto& [steps, b] : heap) result.push_back(b);
  return result;
}

double observed_noise_scale(const LoopConsistency& loops) {
  constexpr std::size_t kMaxSteps = 20;
  constexpr std::size_t kMaxNeighbours = 10;
  constexpr std::size_t kMinPairs = 20;
  constexpr double kQuartile = 0.25;
  constexpr double kMargin = 100.0;
  std::vector<double> ratios;
  for (std::size_t a = 0; a < loops.size(); ++a) {
    const std::vector<std::size_t> nearest = loops.nearest(a, kMaxNeighbours, kMaxSteps);
    if (nearest.empty()) continue;
    const std::size_t b = nearest.back();
    ratios.push_back(loops.chi2(a, b) / chi_square_quantile(kQuartile, loops.degrees_of_freedom(a, b)));
  }
  if (ratios.size() < kMinPairs) return 1.0;
  const auto quartile = ratios.begin() + static_cast<std::ptrdiff_t>(kQuartile * static_cast<double>(ratios.size()));
  std::nth_element(ratios.begin(), quartile, ratios.end());
  return std::min(1.0, kMargin * *quartile);
}

}  // namespace fabloop
