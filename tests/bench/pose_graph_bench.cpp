// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <filesystem>
#include <string>

#include "posegraph/certificate/certificate.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/optimize.h"

namespace fabloop {
namespace {

/// The published graphs, each from the chordal relaxation to the certified optimum. OMP_THREAD_LIMIT=1 makes it one thread.
constexpr const char* kGraphs[] = {
    "tinyGrid3D", "smallGrid3D", "sphere2500", "torus3D", "parking-garage", "cubicle",  "sphere_bignoise_vertex3",
    "manhattan",  "intel",       "MIT",        "CSAIL",   "kitti_00",       "kitti_02", "kitti_05",
    "ring",       "ringCity"};

PoseGraph read(benchmark::State& state) {
  const std::string name = kGraphs[state.range(0)];
  state.SetLabel(name);
  const auto path = std::filesystem::path(FABLOOP_SHARED_DATA_DIR) / "posegraph" / (name + ".g2o");
  if (std::filesystem::exists(path)) return read_g2o(path);
  state.SkipWithError("the graph is not there");
  return {};
}

void PoseGraphSolve(benchmark::State& state) {
  const PoseGraph given = read(state);
  OptimizeReport report;
  for (auto _ : state) {
    PoseGraph graph = given;
    report = optimize(graph, {.initialization = Initialization::Chordal});
  }
  state.counters["cost"] = report.final_cost;
  state.counters["iterations"] = report.iterations;
}

void PoseGraphCertificate(benchmark::State& state) {
  PoseGraph graph = read(state);
  optimize(graph, {.initialization = Initialization::Chordal});
  Certificate certificate;
  for (auto _ : state) certificate = certify(graph);
  state.counters["global"] = certificate.is_global;
  state.counters["cost"] = certificate.cost;
  state.counters["bound"] = certificate.lower_bound;
  state.counters["gap"] = certificate.relative_gap();
  state.counters["eigenvalue"] = certificate.smallest_eigenvalue;
}

BENCHMARK(PoseGraphSolve)->DenseRange(0, std::size(kGraphs) - 1)->Unit(benchmark::kMillisecond);
BENCHMARK(PoseGraphCertificate)->DenseRange(0, std::size(kGraphs) - 1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fabloop
