// SPDX-License-Identifier: BSD-3-Clause
#include "verification/pose/five_point.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <opengv/relative_pose/CentralRelativeAdapter.hpp>
#include <opengv/relative_pose/methods.hpp>

#include "tests/verification/two_view_world.h"
#include "verification/pose/residuals.h"

namespace fabloop {
namespace {

using testing_support::make_two_views;
using Sample = std::array<RayPair, 5>;

constexpr std::size_t kNumBatches = 250;

/// Four samples of exact rays, each of its own pair of views.
struct Batch {
  std::array<Sample, kFivePointLanes> samples;
  std::array<Eigen::Matrix3d, kFivePointLanes> truths;  ///< Of norm one.
};

Batch make_batch(std::size_t number) {
  Batch batch;
  for (std::size_t lane = 0; lane < kFivePointLanes; ++lane) {
    const auto world = make_two_views({.num_points = 5, .seed = number * kFivePointLanes + lane});
    std::copy(world.pairs.begin(), world.pairs.end(), batch.samples[lane].begin());
    // Rays of pixels in single precision are not exact.
    for (RayPair& pair : batch.samples[lane]) {
      const Eigen::Vector3d x_in_query = 10.0 * pair.query;
      pair.match = (world.match_from_query * x_in_query).normalized();
    }
    batch.truths[lane] = essential_matrix(world.match_from_query).normalized();
  }
  return batch;
}

FivePointSamples in_lanes(const std::array<Sample, kFivePointLanes>& samples) {
  FivePointSamples result;
  for (std::size_t lane = 0; lane < kFivePointLanes; ++lane) {
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        result.query[i][k][lane] = samples[lane][i].query(static_cast<Eigen::Index>(k));
        result.match[i][k][lane] = samples[lane][i].match(static_cast<Eigen::Index>(k));
      }
    }
  }
  return result;
}

Eigen::Matrix3d matrix(const std::array<double, 9>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
}

/// By how much a matrix of norm one fails to be an essential matrix of the pairs.
double worst_residual(const Eigen::Matrix3d& e, const Sample& sample) {
  double worst = (2.0 * e * e.transpose() * e - (e * e.transpose()).trace() * e).norm();
  for (const RayPair& pair : sample) worst = std::max(worst, std::abs(pair.match.dot(e * pair.query)));
  return worst;
}

double difference(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) { return std::min((a - b).norm(), (a + b).norm()); }

std::vector<Eigen::Matrix3d> by_opengv(const Sample& sample) {
  opengv::bearingVectors_t match_rays, query_rays;
  for (const RayPair& pair : sample) {
    match_rays.push_back(pair.match);
    query_rays.push_back(pair.query);
  }
  opengv::relative_pose::CentralRelativeAdapter adapter(match_rays, query_rays);
  std::vector<Eigen::Matrix3d> essentials;
  for (const auto& essential : opengv::relative_pose::fivept_nister(adapter)) {
    if (essential.allFinite()) essentials.push_back(Eigen::Matrix3d(essential).normalized());
  }
  return essentials;
}

TEST(FivePoint, SolutionsAreEssentialMatricesOfTheirPairs) {
  std::size_t num_solutions = 0, num_poor = 0;
  for (std::size_t b = 0; b < kNumBatches; ++b) {
    const Batch batch = make_batch(b);
    const FivePointSolutions solutions = five_point(in_lanes(batch.samples));
    for (std::size_t lane = 0; lane < kFivePointLanes; ++lane) {
      for (std::size_t s = 0; s < solutions.count[lane]; ++s) {
        const Eigen::Matrix3d e = matrix(solutions.essentials[lane][s]);
        EXPECT_NEAR(e.norm(), 1.0, 1e-12);
        ++num_solutions;
        num_poor += worst_residual(e, batch.samples[lane]) > 1e-4;
      }
    }
  }
  EXPECT_GT(num_solutions, 2 * kNumBatches * kFivePointLanes);
  // Roots that lie close together are known to half the digits only.
  EXPECT_LT(static_cast<double>(num_poor), 0.02 * static_cast<double>(num_solutions));
}

TEST(FivePoint, FindsTheTruthAsOftenAsOpenGv) {
  std::size_t num_found = 0, num_found_by_opengv = 0;
  for (std::size_t b = 0; b < kNumBatches; ++b) {
    const Batch batch = make_batch(b);
    const FivePointSolutions solutions = five_point(in_lanes(batch.samples));
    for (std::size_t lane = 0; lane < kFivePointLanes; ++lane) {
      const auto is_truth = [&](const Eigen::Matrix3d& essential) { return difference(essential, batch.truths[lane]) < 1e-3; };
      const auto* const first = solutions.essentials[lane].data();
      num_found += std::any_of(first, first + solutions.count[lane], [&](const auto& rows) { return is_truth(matrix(rows)); });
      const auto reference = by_opengv(batch.samples[lane]);
      num_found_by_opengv += std::any_of(reference.begin(), reference.end(), is_truth);
    }
  }
  constexpr double kSampling = 0.01;  // of 1000 samples
  const auto total = static_cast<double>(kNumBatches * kFivePointLanes);
  EXPECT_GT(static_cast<double>(num_found) / total, static_cast<double>(num_found_by_opengv) / total - kSampling);
}

TEST(FivePoint, FindsWhatOpenGvFinds) {
  std::size_t num_reference = 0, num_found = 0;
  for (std::size_t b = 0; b < kNumBatches; ++b) {
    const Batch batch = make_batch(b);
    const FivePointSolutions solutions = five_point(in_lanes(batch.samples));
    for (std::size_t lane = 0; lane < kFivePointLanes; ++lane) {
      const auto* const first = solutions.essentials[lane].data();
      for (const Eigen::Matrix3d& reference : by_opengv(batch.samples[lane])) {
        if (worst_residual(reference, batch.samples[lane]) > 1e-8) continue;  // it blurs some, and finds some that are none
        ++num_reference;
        num_found += std::any_of(first, first + solutions.count[lane],
                                 [&](const auto& rows) { return difference(matrix(rows), reference) < 1e-3; });
      }
    }
  }
  // Near-double roots are missed now and then.
  EXPECT_GT(static_cast<double>(num_found), 0.95 * static_cast<double>(num_reference));
}

TEST(FivePoint, LanesDoNotMeetOneAnother) {
  const Batch batch = make_batch(3);
  auto samples = batch.samples;
  const FivePointSolutions all = five_point(in_lanes(samples));
  samples[1] = samples[2] = samples[3] = samples[0];
  const FivePointSolutions alone = five_point(in_lanes(samples));
  ASSERT_EQ(all.count[0], alone.count[0]);
  for (std::size_t s = 0; s < all.count[0]; ++s) {
    EXPECT_LT(difference(matrix(all.essentials[0][s]), matrix(alone.essentials[0][s])), 1e-9);
  }
}

TEST(FivePoint, RepeatedRaysGiveNoNonsense) {
  Sample sample = make_batch(0).samples[0];
  for (RayPair& pair : sample) pair = sample[0];
  const FivePointSolutions solutions = five_point(in_lanes({sample, sample, sample, sample}));
  for (std::size_t lane = 0; lane < kFivePointLanes; ++lane) {
    for (std::size_t s = 0; s < solutions.count[lane]; ++s) EXPECT_TRUE(matrix(solutions.essentials[lane][s]).allFinite());
  }
}

}  // namespace
}  // namespace fabloop
