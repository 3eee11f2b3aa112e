// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "frontend/fabmap/chow_liu_training.h"
#include "frontend/fabmap/place_recognizer.h"
#include "frontend/fabmap/vocabulary.h"
#include "frontend/fabmap/vocabulary_training.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

constexpr std::size_t kNumWords = 10000;
constexpr double kMeanP = 0.03;  // About 300 words an image.

const ChowLiuTree& tree() {
  static const ChowLiuTree result = testing::random_tree(kNumWords, kMeanP, 1);
  return result;
}

/// Bytes that are allocated now, wherever malloc put them.
double allocated_bytes() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

/// A map of many places. Large ones repeat 10,000 drawn places, since drawing takes longer than adding.
PlaceRecognizer map_of(std::size_t num_places, testing::TreeSampler& sampler,
                       LikelihoodEngine engine = LikelihoodEngine::InvertedIndex) {
  PlaceRecognizerOptions options;
  options.engine = engine;
  PlaceRecognizer recognizer(tree(), {}, {}, options);
  const std::vector<Observation> drawn = sampler.draw(std::min<std::size_t>(num_places, 10000));
  for (std::size_t i = 0; i < num_places; ++i) recognizer.add_place(drawn[i * 7919 % drawn.size()]);
  return recognizer;
}

void query(benchmark::State& state, LikelihoodEngine engine) {
  testing::TreeSampler sampler(tree(), 2);
  const double bytes_before = allocated_bytes();
  const PlaceRecognizer recognizer = map_of(static_cast<std::size_t>(state.range(0)), sampler, engine);
  const double bytes = allocated_bytes() - bytes_before;
  const std::vector<Observation> queries = sampler.draw(64);
  const Prior prior = uniform_prior(recognizer.num_places());
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(recognizer.recognize(queries[i++ % queries.size()], prior));
  state.counters["ns/place"] = benchmark::Counter(static_cast<double>(state.range(0)) * 1e-9,
                                                  benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
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
  testing::TreeSampler sampler(tree(), 2);
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
  testing::TreeSampler sampler(tree(), 3);
  PlaceRecognizer recognizer = map_of(static_cast<std::size_t>(state.range(0)), sampler);
  const std::vector<Observation> observations = sampler.draw(256);
  std::size_t i = 0;
  for (auto _ : state) recognizer.add_place(observations[i++ % observations.size()]);
}
BENCHMARK(add_place)->Name("FabMapAddPlace")->ArgName("places")->Arg(10000)->Unit(benchmark::kMicrosecond);

void chow_liu(benchmark::State& state) {
  const auto num_words = static_cast<std::size_t>(state.range(0));
  const ChowLiuTree truth = testing::random_tree(num_words, kMeanP, 4);
  const std::vector<Observation> observations = testing::TreeSampler(truth, 4).draw(static_cast<std::size_t>(state.range(1)));
  for (auto _ : state) benchmark::DoNotOptimize(train_chow_liu_tree(observations, num_words));
}
BENCHMARK(chow_liu)
    ->Name("ChowLiu")
    ->ArgNames({"words", "images"})
    ->Args({1000, 1000})
    ->Args({10000, 2500})
    ->Unit(benchmark::kMillisecond);

cv::Mat random_descriptors(int count, int dimensions, std::uint64_t seed) {
  cv::Mat descriptors(count, dimensions, CV_32F);
  cv::RNG(seed).fill(descriptors, cv::RNG::UNIFORM, 0.0, 1.0);
  return descriptors;
}

void find_words(benchmark::State& state) {
  const int dimensions = 128;
  const Vocabulary vocabulary{random_descriptors(static_cast<int>(state.range(0)), dimensions, 5)};
  const cv::Mat descriptors = random_descriptors(static_cast<int>(state.range(1)), dimensions, 6);
  for (auto _ : state) benchmark::DoNotOptimize(nearest_words(vocabulary, descriptors));
}
BENCHMARK(find_words)
    ->Name("NearestWords")
    ->ArgNames({"words", "descriptors"})
    ->Args({1000, 1000})
    ->Args({10000, 1000})
    ->Unit(benchmark::kMillisecond);

void k_means(benchmark::State& state) {
  const cv::Mat descriptors = random_descriptors(static_cast<int>(state.range(1)), 64, 7);
  KMeansOptions options;
  options.num_words = static_cast<std::size_t>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(train_k_means(descriptors, options));
}
BENCHMARK(k_means)
    ->Name("KMeans")
    ->ArgNames({"words", "descriptors"})
    ->Args({1000, 100000})
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fabloop
