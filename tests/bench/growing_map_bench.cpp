// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

#include "posegraph/incremental_map.h"
#include "posegraph/marginal_covariance.h"
#include "tests/posegraph/long_walk.h"

namespace fabloop {
namespace {

/// Value below which a share of them lies.
double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size()))];
}

/// Steps over the last tenth of a walk of `range(0)` poses with a loop every `range(1)` poses: median and 99th percentile, by the
/// wall's clock and in processor time, which a busy machine does not stretch.
void incremental_step(benchmark::State& state) {
  test::LongWalkOptions walk;
  walk.num_poses = static_cast<std::size_t>(state.range(0));
  walk.loop_every = static_cast<std::size_t>(state.range(1));
  const PoseGraph graph = test::make_long_walk(walk);
  for (auto _ : state) {
    IncrementalMap map;
    std::vector<double> steps_ms;
    std::vector<double> steps_cpu_ms;
    std::size_t edge = 0;
    for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
      const bool is_measured = 10 * v >= 9 * graph.vertices.size();
      const Matrix6d information = v == 0 ? Matrix6d::Identity() : graph.edges[edge++].information;
      const auto start = std::chrono::steady_clock::now();
      const std::clock_t cpu_start = std::clock();
      map.add_keyframe(graph.vertices[v].id, graph.vertices[v].world_from_frame, information);
      for (; edge < graph.edges.size() && graph.edges[edge].kind == EdgeKind::Loop; ++edge) map.add_edge(graph.edges[edge]);
      // What came before is solved once, so that the measured steps begin at a settled map.
      if (is_measured) {
        map.step();
        steps_ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        steps_cpu_ms.push_back(1e3 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
      } else if (10 * (v + 1) >= 9 * graph.vertices.size()) {
        map.finish();
      }
    }
    state.counters["p50_ms"] = quantile(steps_ms, 0.5);
    state.counters["p99_ms"] = quantile(steps_ms, 0.99);
    state.counters["p50_cpu_ms"] = quantile(steps_cpu_ms, 0.5);
    state.counters["p99_cpu_ms"] = quantile(steps_cpu_ms, 0.99);
  }
}
BENCHMARK(incremental_step)->Args({5000, 20})->Args({5000, 2})->Iterations(1)->Unit(benchmark::kSecond);

/// A walk of `range(0)` poses with a loop every second pose, solved at once.
void batch(benchmark::State& state) {
  test::LongWalkOptions walk;
  walk.num_poses = static_cast<std::size_t>(state.range(0));
  walk.lap = 1000;
  const PoseGraph graph = test::make_long_walk(walk);
  for (auto _ : state) {
    PoseGraph solved = graph;
    const OptimizeReport report = optimize(solved);
    state.counters["iterations"] = report.iterations;
    state.counters["loops"] = static_cast<double>(graph.edges.size() - graph.vertices.size() + 1);
    state.counters["cost"] = report.final_cost;
  }
}
BENCHMARK(batch)->Arg(5000)->Arg(100'000)->Iterations(1)->Unit(benchmark::kSecond);

/// Covariance of ten poses of a walk of `range(0)`.
void marginals(benchmark::State& state) {
  test::LongWalkOptions walk;
  walk.num_poses = static_cast<std::size_t>(state.range(0));
  const PoseGraph graph = test::make_long_walk(walk);
  std::vector<std::size_t> asked;
  for (std::size_t k = 1; k <= 10; ++k) asked.push_back(k * walk.num_poses / 11);
  for (auto _ : state) benchmark::DoNotOptimize(marginal_covariance(graph, asked));
}
BENCHMARK(marginals)->Arg(5000)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace fabloop
