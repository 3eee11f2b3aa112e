// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/exposure.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fabloop {
namespace {

constexpr int kPowers = 3;

/// One block seen by two views.
struct Pair {
  std::size_t view_a, view_b;
  double radius_a, radius_b;
  cv::Vec3d log_ratio;  ///< log of b's colour over a's.
};

bool is_usable(const cv::Vec3b& colour) {
  constexpr int kDark = 6;
  constexpr int kBright = 249;  // clipped: its true brightness is not known
  return std::min({colour[0], colour[1], colour[2]}) > kDark && std::max({colour[0], colour[1], colour[2]}) < kBright;
}

/// Pairs of well-seen views, of at most so many blocks evenly over all.
std::vector<Pair> collect_pairs(const MosaicBlocks& blocks) {
  constexpr std::size_t kMaxBlocks = 12000;
  constexpr double kWellSeen = 0.2;
  std::vector<Pair> pairs;
  const std::size_t stride = std::max<std::size_t>(1, blocks.size() / kMaxBlocks);
  for (std::size_t block = 0; block < blocks.size(); block += stride) {
    const auto seen = blocks.at(block);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      for (std::size_t j = i + 1; j < seen.size(); ++j) {
        const BlockView& a = seen[i];
        const BlockView& b = seen[j];
        if (b.quality < kWellSeen * seen[0].quality || !is_usable(a.colour) || !is_usable(b.colour)) continue;
        cv::Vec3d log_ratio;
        for (int k = 0; k < 3; ++k) log_ratio[k] = std::log(static_cast<double>(b.colour[k]) / a.colour[k]);
        pairs.push_back({a.view, b.view, a.radius, b.radius, log_ratio});
      }
    }
  }
  return pairs;
}

/// The unknowns of one channel: gains, then the powers of each camera.
class ChannelProblem {
 public:
  ChannelProblem(const std::vector<Pair>& pairs, const std::vector<std::size_t>& camera_of, std::size_t num_cameras, int channel)
      : pairs_(pairs),
        camera_of_(camera_of),
        channel_(channel),
        size_(static_cast<Eigen::Index>(camera_of.size() + kPowers * num_cameras)) {}

  Eigen::VectorXd solve() const {
    constexpr int kRounds = 5;
    Eigen::VectorXd x = Eigen::VectorXd::Zero(size_);
    for (int round = 0; round < kRounds; ++round) x = solve_weighted(x);
    return x;
  }

 private:
  struct Row {
    std::array<Eigen::Index, 2 + 2 * kPowers> columns;
    std::array<double, 2 + 2 * kPowers> values;
  };

  /// (g_a + f_a(r_a)) - (g_b + f_b(r_b)) = log(b / a).
  Row row_of(const Pair& pair) const {
    Row row{};
    std::size_t at = 0;
    const auto add = [&](std::size_t view, double radius, double sign) {
      row.columns[at] = static_cast<Eigen::Index>(view);
      row.values[at++] = sign;
      double power = 1;
      for (std::size_t k = 0; k < kPowers; ++k) {
        power *= radius * radius;
        row.columns[at] = static_cast<Eigen::Index>(camera_of_.size() + kPowers * camera_of_[view] + k);
        row.values[at++] = sign * power;
      }
    };
    add(pair.view_a, pair.radius_a, 1);
    add(pair.view_b, pair.radius_b, -1);
    return row;
  }

  Eigen::VectorXd solve_weighted(const Eigen::VectorXd& before) const {
    constexpr double kHuber = 0.05;
    const auto num_gains = static_cast<Eigen::Index>(camera_of_.size());
    std::vector<Eigen::Triplet<double>> triplets;
    // Rows of the few unknowns that every pair has: summed at once, where gains of two views meet in few pairs.
    Eigen::MatrixXd falloff = Eigen::MatrixXd::Zero(size_, size_ - num_gains);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size_);
    for (const Pair& pair : pairs_) {
      const Row row = row_of(pair);
      double residual = -pair.log_ratio[channel_];
      for (std::size_t i = 0; i < row.columns.size(); ++i) residual += row.values[i] * before(row.columns[i]);
      const double weight = std::abs(residual) > kHuber ? kHuber / std::abs(residual) : 1.0;
      for (std::size_t i = 0; i < row.columns.size(); ++i) {
        right(row.columns[i]) += weight * row.values[i] * pair.log_ratio[channel_];
        for (std::size_t j = 0; j < row.columns.size(); ++j) {
          const double value = weight * row.values[i] * row.values[j];
          if (row.columns[j] >= num_gains) {
            falloff(row.columns[i], row.columns[j] - num_gains) += value;
          } else if (row.columns[i] < num_gains) {
            triplets.emplace_back(row.columns[i], row.columns[j], value);
          }
        }
      }
    }
    // Weak pulls: towards gain 1 (gains all alike are free otherwise), and towards no fall-off.
    const double pull = 1e-3 * (1.0 + static_cast<double>(pairs_.size()) / static_cast<double>(camera_of_.size()));
    for (Eigen::Index i = 0; i < size_; ++i) triplets.emplace_back(i, i, pull);
    for (Eigen::Index j = num_gains; j < size_; ++j) {
      for (Eigen::Index i = 0; i < size_; ++i) {
        triplets.emplace_back(i, j, falloff(i, j - num_gains));
        if (i < num_gains) triplets.emplace_back(j, i, falloff(i, j - num_gains));
      }
    }
    Eigen::SparseMatrix<double> normal(size_, size_);
    normal.setFromTriplets(triplets.begin(), triplets.end());
    return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(normal).solve(right);
  }

  const std::vector<Pair>& pairs_;
  const std::vector<std::size_t>& camera_of_;
  int channel_;
  Eigen::Index size_;
};

}  // namespace

cv::Vec3f Exposure::gain(std::size_t view, std::size_t camera, double radius) const {
  const double r2 = radius * radius;
  cv::Vec3f result;
  for (int k = 0; k < 3; ++k) {
    const auto& f = log_falloff[camera][static_cast<std::size_t>(k)];
    result[k] = static_cast<float>(std::exp(log_gain[view][k] + r2 * (f[0] + r2 * (f[1] + r2 * f[2]))));
  }
  return result;
}

Exposure equalise_exposure(const MosaicBlocks& blocks, const std::vector<std::size_t>& camera_of, std::size_t num_cameras) {
  Exposure exposure;
  exposure.log_gain.resize(camera_of.size());
  exposure.log_falloff.resize(num_cameras);
  const std::vector<Pair> pairs = collect_pairs(blocks);
  for (int channel = 0; channel < 3; ++channel) {
    const Eigen::VectorXd x = ChannelProblem(pairs, camera_of, num_cameras, channel).solve();
    for (std::size_t view = 0; view < camera_of.size(); ++view) {
      exposure.log_gain[view][channel] = x(static_cast<Eigen::Index>(view));
    }
    for (std::size_t camera = 0; camera < num_cameras; ++camera) {
      for (std::size_t k = 0; k < kPowers; ++k) {
        exposure.log_falloff[camera][static_cast<std::size_t>(channel)][k] =
            x(static_cast<Eigen::Index>(camera_of.size() + kPowers * camera + k));
      }
    }
  }
  return exposure;
}

cv::Mat3f drift_factors(const Exposure& exposure, const std::vector<Eigen::Vector2d>& places, const GroundGrid& grid,
                        double reach) {
  constexpr int kStride = 16;  // the factors are smooth
  const GroundGrid coarse = coarser(grid, kStride);
  cv::Mat3f factors(coarse.rows, coarse.columns, cv::Vec3f(1, 1, 1));
  for (int row = 0; row < coarse.rows; ++row) {
    for (int column = 0; column < coarse.columns; ++column) {
      const Eigen::Vector2d x = coarse.ground_at(column, row);
      cv::Vec3d sum;
      double total = 0;
      for (std::size_t view = 0; view < places.size(); ++view) {
        const double weight = std::exp(-0.5 * (x - places[view]).squaredNorm() / (reach * reach));
        sum += weight * exposure.log_gain[view];
        total += weight;
      }
      if (!(total > 0)) continue;  // far from all views
      for (int k = 0; k < 3; ++k) factors(row, column)[k] = static_cast<float>(std::exp(-sum[k] / total));
    }
  }
  cv::Mat3f fine;
  cv::resize(factors, fine, {}, kStride, kStride, cv::INTER_LINEAR);
  return fine(cv::Rect(0, 0, grid.columns, grid.rows)).clone();
}

}  // namespace fabloop
