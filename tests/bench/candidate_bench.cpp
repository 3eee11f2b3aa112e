// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "frontend/features/feature_extractor.h"
#include "frontend/sequence/sequence.h"
#include "frontend/stopwatch.h"
#include "verification/verifier.h"
#include "verification/view.h"

namespace fabloop {
namespace {

/// Frames this far apart: from pairs that overlap widely to pairs of different places.
constexpr std::array<std::size_t, 6> kSteps{1, 3, 8, 20, 45, 70};

/// Views of every tenth frame of a flight and of those some steps later, as candidates.
struct Candidates {
  std::vector<View> views;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< Query, match.
};

Candidates candidates_of(const std::string& flight, int num_features) {
  const std::filesystem::path folder = std::filesystem::path(FABLOOP_SHARED_DATA_DIR) / "aerial" / flight;
  Candidates candidates;
  if (!std::filesystem::exists(folder)) return candidates;
  const Sequence sequence = read_sequence(folder);
  FeatureOptions options;
  options.max_features = num_features;
  const FeatureExtractor extractor(options);
  std::vector<std::size_t> view_of(sequence.frames.size(), sequence.frames.size());
  const auto view = [&](std::size_t frame) {
    if (view_of[frame] == sequence.frames.size()) {
      view_of[frame] = candidates.views.size();
      candidates.views.push_back(make_view(
          frame, sequence.camera, extractor.extract(read_gray_image(sequence.frames[frame].image_path, sequence.camera))));
    }
    return view_of[frame];
  };
  for (std::size_t match = 0; match < sequence.frames.size(); match += 10) {
    for (const std::size_t step : kSteps) {
      if (match + step < sequence.frames.size()) candidates.pairs.emplace_back(view(match + step), view(match));
    }
  }
  return candidates;
}

/// Everything that a candidate costs once its features are there: matching, RANSAC, refinement, scale, covariance, gates.
void verify_candidates(benchmark::State& state, const std::string& flight) {
  const Candidates candidates = candidates_of(flight, static_cast<int>(state.range(0)));
  if (candidates.pairs.empty()) {
    state.SkipWithError("the aerial images of ../shared/data are not here");
    return;
  }
  const Verifier verifier;
  std::vector<double> accepted_s, rejected_s;
  for (auto _ : state) {
    for (const auto& [query, match] : candidates.pairs) {
      double seconds = 0;
      Verification found;
      {
        const Stopwatch watch(seconds);
        found = verifier.verify(candidates.views[query], candidates.views[match]);
      }
      (found.verdict == Verdict::Accepted ? accepted_s : rejected_s).push_back(seconds);
    }
  }
  const auto median_ms = [](std::vector<double> seconds) {
    if (seconds.empty()) return 0.0;
    const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
    std::nth_element(seconds.begin(), middle, seconds.end());
    return 1e3 * *middle;
  };
  state.counters["accepted_median_ms"] = median_ms(accepted_s);
  state.counters["rejected_median_ms"] = median_ms(rejected_s);
  std::vector<double> all_s = accepted_s;
  all_s.insert(all_s.end(), rejected_s.begin(), rejected_s.end());
  state.counters["median_ms"] = median_ms(all_s);
  state.counters["accepted_share"] = static_cast<double>(accepted_s.size()) / static_cast<double>(all_s.size());
}

BENCHMARK_CAPTURE(verify_candidates, sheffield_cross, std::string("sheffield_cross"))
    ->Name("Candidate/sheffield_cross")
    ->Arg(1000)
    ->Arg(2000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(verify_candidates, caliterra, std::string("caliterra"))
    ->Name("Candidate/caliterra")
    ->Arg(1000)
    ->Arg(2000)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fabloop
