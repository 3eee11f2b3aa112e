// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

#include "frontend/fabmap/place_recognizer.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

constexpr std::size_t kNumWords = 10000;
constexpr double kMeanP = 0.03;  // About 300 words an image.

const ChowLiuTree& tree() {
  static const ChowLiuTree result = testing::random_tree(kNumWords, kMeanP, 1);
  return result;
}

PlaceRecognizer map_of(std::size_t num_places, testing::TreeSampler& sampler) {
  PlaceRecognizer recognizer(tree(), {});
  for (std::size_t i = 0; i < num_places; ++i) recognizer.add_place(sampler.draw());
  return recognizer;
}

void query(benchmark::State& state) {
  testing::TreeSampler sampler(tree(), 2);
  const PlaceRecognizer recognizer = map_of(static_cast<std::size_t>(state.range(0)), sampler);
  const std::vector<Observation> queries = sampler.draw(64);
  const Prior prior = uniform_prior(recognizer.num_places());
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(recognizer.recognize(queries[i++ % queries.size()], prior));
}
BENCHMARK(query)->Name("FabMapQuery")->ArgName("places")->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

void add_place(benchmark::State& state) {
  testing::TreeSampler sampler(tree(), 3);
  PlaceRecognizer recognizer = map_of(static_cast<std::size_t>(state.range(0)), sampler);
  const std::vector<Observation> observations = sampler.draw(256);
  std::size_t i = 0;
  for (auto _ : state) recognizer.add_place(observations[i++ % observations.size()]);
}
BENCHMARK(add_place)->Name("FabMapAddPlace")->ArgName("places")->Arg(10000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fabloop
