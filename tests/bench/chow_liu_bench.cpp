// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "frontend/fabmap/chow_liu_training.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

constexpr double kWordsPerImage = 300.0;

void chow_liu(benchmark::State& state) {
  const auto num_words = static_cast<std::size_t>(state.range(0));
  const double mean_p = std::min(0.03, kWordsPerImage / static_cast<double>(num_words));
  const ChowLiuTree truth = testing_support::random_tree(num_words, mean_p, 4);
  const std::vector<Observation> observations =
      testing_support::TreeSampler(truth, 4).draw(static_cast<std::size_t>(state.range(1)));
  for (auto _ : state) benchmark::DoNotOptimize(train_chow_liu_tree(observations, num_words));
}
BENCHMARK(chow_liu)
    ->Name("ChowLiu")
    ->ArgNames({"words", "images"})
    ->Args({1000, 1000})
    ->Args({10000, 2500})
    ->Args({100000, 10000})
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fabloop
