// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/run/run_memory.h"

#if __has_include(<sys/resource.h>)
#include <sys/resource.h>
#endif

#include <cstddef>
#include <nlohmann/json.hpp>

namespace fabloop {
namespace {

constexpr double kMib = 1024.0 * 1024.0;

template <typename T>
std::size_t bytes_of(const std::vector<T>& list) {
  return list.size() * sizeof(T);
}

}  // namespace

std::string memory_json(const Map& map) {
  std::size_t features = 0, geometry = 0, ledger = 0;
  for (const View& view : map.views) {
    features += bytes_of(view.features.keypoints) + view.features.descriptors.total() * view.features.descriptors.elemSize();
    geometry += bytes_of(view.rays) + bytes_of(view.points_in_camera) + bytes_of(view.point_weights);
  }
  for (const LoopEvent& event : map.events) {
    ledger += sizeof(event) + bytes_of(event.hypotheses) + bytes_of(event.neighbours);
    for (const HypothesisOutcome& outcome : event.hypotheses) ledger += bytes_of(outcome.verification.inliers);
  }
  const std::size_t graph = bytes_of(map.graph.vertices) + bytes_of(map.graph.edges) + bytes_of(map.report.edges);
  const auto mib = [](std::size_t bytes) { return static_cast<double>(bytes) / kMib; };
  return nlohmann::ordered_json{
      {"features_mib", mib(features)}, {"geometry_mib", mib(geometry)}, {"ledger_mib", mib(ledger)}, {"graph_mib", mib(graph)}}
      .dump();
}

double peak_memory_mib() {
#if __has_include(<sys/resource.h>)
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0.0;
#ifdef __APPLE__
  constexpr double kUnitsPerMib = kMib;
#else
  constexpr double kUnitsPerMib = 1024.0;
#endif
  return static_cast<double>(usage.ru_maxrss) / kUnitsPerMib;
#else
  return 0.0;
#endif
}

}  // namespace fabloop
