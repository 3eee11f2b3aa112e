// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/row_projection.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "frontend/features/dot_products.h"

namespace fabloop {
namespace {

/// More rows tell no more about where they vary.
constexpr int kMaxRows = 20000;
/// Directions that hold so much of the variance leave few rows within the bound (RootSIFT: about 13 of 10,000 words).
constexpr double kVariance = 0.9;
/// With more directions than this part of all, comparing rows as they are is faster.
constexpr double kMaxPart = 0.6;
/// Numbers that a row's coordinates take in a search, with its remainder and its norm.
constexpr std::size_t kMultiple = 8, kOthers = 2;
constexpr std::size_t kMaxDirections = 512;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Every n-th row, less the mean of those.
RowMajor some_centred(const cv::Mat& rows, Eigen::RowVectorXd& mean) {
  const int step = (rows.rows + kMaxRows - 1) / kMaxRows;
  RowMajor some((rows.rows + step - 1) / step, rows.cols);
  for (int i = 0; i < some.rows(); ++i) {
    some.row(i) = Eigen::Map<const Eigen::RowVectorXf>(rows.ptr<float>(i * step), rows.cols).cast<double>();
  }
  mean = some.colwise().mean();
  some.rowwise() -= mean;
  return some;
}

std::size_t directions_for(const Eigen::VectorXd& ascending_variances) {
  const auto dimension = static_cast<std::size_t>(ascending_variances.size());
  const double wanted = kVariance * ascending_variances.sum();
  double held = 0.0;
  std::size_t count = 0;
  while (count < dimension && held < wanted) held += ascending_variances[static_cast<Eigen::Index>(dimension - ++count)];
  count = (count + kOthers + kMultiple - 1) / kMultiple * kMultiple - kOthers;
  const bool too_many = count > kMaxDirections || static_cast<double>(count) > kMaxPart * static_cast<double>(dimension);
  return too_many ? dimension : count;
}

}  // namespace

RowProjection::RowProjection(const cv::Mat& rows) : dimension_(static_cast<std::size_t>(rows.cols)) {
  Eigen::RowVectorXd mean;
  const RowMajor some = some_centred(rows, mean);
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(rows.cols, rows.cols);
  scatter.selfadjointView<Eigen::Lower>().rankUpdate(some.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scatter);
  num_directions_ = solver.info() == Eigen::Success ? directions_for(solver.eigenvalues()) : dimension_;
  mean_.assign(mean.data(), mean.data() + mean.size());
  if (num_directions_ == dimension_) return;
  const auto count = static_cast<Eigen::Index>(num_directions_);
  RowMajor best = RowMajor::Zero(rows.cols, count + static_cast<Eigen::Index>(kOthers));
  best.leftCols(count) = solver.eigenvectors().rightCols(count).rowwise().reverse();
  directions_.assign(best.data(), best.data() + best.size());
}

double RowProjection::project(const float* row, float* coordinates) const {
  double sums[kMaxDirections + kOthers];
  centred_products(row, mean_.data(), dimension_, directions_.data(), num_directions_ + kOthers, sums);
  double squared_norm = 0.0;
  for (std::size_t d = 0; d < dimension_; ++d) {
    const double value = static_cast<double>(row[d]) - mean_[d];
    squared_norm += value * value;
  }
  double remainder = squared_norm;
  for (std::size_t j = 0; j < num_directions_; ++j) {
    remainder -= sums[j] * sums[j];
    coordinates[j] = static_cast<float>(sums[j]);
  }
  coordinates[num_directions_] = static_cast<float>(std::sqrt(std::max(0.0, remainder)));
  return std::sqrt(squared_norm);
}

}  // namespace fabloop
