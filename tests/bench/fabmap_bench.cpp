// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "frontend/fabmap/place_recognizer.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

constexpr std::size_t kNumWords = 10000;
constexpr double kMeanP = 0.03;  // About 300 words an image.

const ChowLiuTree& tree() {
  static const ChowLiuTree result = testing_support::random_tree(kNumWords, kMeanP, 1);
  return result;
}

/// Bytes that are allocated now, wherever malloc put them.
double allocated_bytes() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

/// A map of many places. Large ones repeat 10,000 drawn places, since drawing takes longer than adding.
PlaceRecognizer map_of(std::size_t num_places, testing_support::TreeSampler& sampler,
                       LikelihoodEngine engine = LikelihoodEngine::InvertedIndex) {
  PlaceRecognizerOptions options;
  options.engine = engine;
  PlaceRecognizer recognizer(tree(), {}, {}, options);
  const std::vector<Observation> drawn = sampler.draw(std::min<std::size_t>(num_places, 10000));
  for (std::size_t i = 0; i < num_places; ++i) recognizer.add_place(drawn[i * 7919 % drawn.size()]);
  return recognizer;
}

void query(benchmark::State& state, LikelihoodEngine engine) {
  testing_support::TreeSampler sampler(tree(), 2);
  const double bytes_before = allocated_bytes();
  const PlaceRecognizer recognizer = map_of(static_cast<std::size_t>(state.range(0)), sampler, engine);
  const double bytes = allocated_bytes() - bytes_before;
  const std::vector<Observation> queries = sampler.draw(64);
  const Prior prior = uniform_prior(recognizer.num_places());
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(recognizer.recognize(queries[i++ % queries.size()], prior));
  state.counters["places/s"] =
      benchmark::Counter(static_cast<double>(state.range(0)), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["bytes/place"] = bytes / static_cast<double>(state.range(0));
}
BENCHMARK_CAPTURE(query, index, LikelihoodEngine::InvertedIndex)
    ->Name("FabMapQuery/index")
    ->ArgName("places")
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(query, bail_out, LikelihoodEngine::BailOut)
    ->Name("FabMapQuery/bail-out")
    ->ArgName("places")
    ->Arg(10000)
    ->Arg(100000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(query, table, LikelihoodEngine::Table)
    ->Name("FabMapQuery/table")
    ->ArgName("places")
    ->Arg(10000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(query, exact, LikelihoodEngine::Exact)
    ->Name("FabMapQuery/exact")
    ->ArgName("places")
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond);

/// A map of video: every place was visited ten times.
void query_after_revisits(benchmark::State& state) {
  testing_support::TreeSampler sampler(tree(), 2);
  PlaceRecognizer recognizer = map_of(static_cast<std::size_t>(state.range(0)), sampler);
  const std::vector<Observation> visits = sampler.draw(9);
  for (PlaceId place = 0; place < recognizer.num_places(); ++place) {
    for (const Observation& visit : visits) recognizer.add_visit(place, visit);
  }
  const std::vector<Observation> queries = sampler.draw(64);
  const Prior prior = uniform_prior(recognizer.num_places());
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(recognizer.recognize(queries[i++ % queries.size()], prior));
}
BENCHMARK(query_after_revisits)
    ->Name("FabMapQueryAfterTenVisitsEach")
    ->ArgName("places")
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond);

void add_place(benchmark::State& state) {
  testing_support::TreeSampler sampler(tree(), 3);
  PlaceRecognizer recognizer = map_of(static_cast<std::size_t>(state.range(0)), sampler);
  const std::vector<Observation> observations = sampler.draw(256);
  std::size_t i = 0;
  for (auto _ : state) recognizer.add_place(observations[i++ % observations.size()]);
}
BENCHMARK(add_place)->Name("FabMapAddPlace")->ArgName("places")->Arg(10000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fabloop
