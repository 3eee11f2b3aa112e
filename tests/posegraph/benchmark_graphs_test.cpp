// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>

#include "posegraph/certificate/certificate.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/optimize.h"

namespace fabloop {
namespace {

/// A published graph and the optimum of the chordal objective: SE-Sync's (Rosen et al., IJRR 2019), where there is one.
struct Published {
  const char* name;
  double optimum;
  /// Figures have this many digits, or differ from the proved bounds by so much.
  double relative_tolerance = 1e-5;
};

// Names of tests.
void PrintTo(const Published& graph, std::ostream* out) { *out << graph.name; }

class BenchmarkGraphs : public testing::TestWithParam<Published> {};

TEST_P(BenchmarkGraphs, ReachTheirCertifiedOptimum) {
  const Published& published = GetParam();
  const auto path = std::filesystem::path(FABLOOP_SHARED_DATA_DIR) / "posegraph" / (std::string(published.name) + ".g2o");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  PoseGraph graph = read_g2o(path);
  const OptimizeReport report = optimize(graph, {.initialization = Initialization::Chordal});
  EXPECT_EQ(report.termination, Termination::Converged) << report.full();
  EXPECT_NEAR(report.final_cost, published.optimum, published.relative_tolerance * published.optimum) << report.full();
  const Certificate certificate = certify(graph);
  EXPECT_TRUE(certificate.is_global) << certificate.brief();
  // The gap asked for, and what rounding adds where weights are large.
  EXPECT_LT(certificate.relative_gap(), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(All, BenchmarkGraphs,
                         testing::Values(Published{"tinyGrid3D", 18.519, 3e-5}, Published{"smallGrid3D", 1025.398},
                                         Published{"sphere2500", 1687.006}, Published{"torus3D", 24227.04},
                                         // Published as 1.262485 and 717.134; the certificates prove that no poses cost 1.262522,
                                         // and that 717.126 is the minimum.
                                         Published{"parking-garage", 1.262524}, Published{"cubicle", 717.126},
                                         Published{"sphere_bignoise_vertex3", 2961756.5}, Published{"manhattan", 6431.39},
                                         Published{"intel", 52.348}, Published{"MIT", 61.154}, Published{"CSAIL", 31.704, 2e-5},
                                         Published{"kitti_00", 125.694}, Published{"kitti_02", 108.351},
                                         Published{"kitti_05", 276.514},
                                         // No other program's figures.
                                         Published{"ring", 11.257522}, Published{"ringCity", 271.77593}));

}  // namespace
}  // namespace fabloop
