// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <cstdint>
#include <filesystem>
#include <numeric>
#include <opencv2/core.hpp>
#include <vector>

#include "frontend/fabmap/model.h"
#include "frontend/fabmap/nearest_rows.h"
#include "frontend/fabmap/vocabulary.h"
#include "frontend/fabmap/vocabulary_training.h"
#include "frontend/fabmap/word_finder.h"
#include "tests/bench/real_descriptors.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

cv::Mat random_descriptors(int count, int dimensions, std::uint64_t seed) {
  cv::Mat descriptors(count, dimensions, CV_32F);
  cv::RNG(seed).fill(descriptors, cv::RNG::UNIFORM, 0.0, 1.0);
  return descriptors;
}

/// Around 5,000 centres, with directions of ever smaller variance: like descriptors, without data.
cv::Mat random_mixture(int count, int dimensions, std::uint64_t seed) {
  constexpr int kNumCentres = 5000;
  cv::RNG generator(seed);
  cv::Mat centres(kNumCentres, dimensions, CV_32F), points(count, dimensions, CV_32F);
  cv::RNG(99).fill(centres, cv::RNG::NORMAL, 0.0, 1.0);
  generator.fill(points, cv::RNG::NORMAL, 0.0, 0.5);
  for (int i = 0; i < count; ++i) points.row(i) += centres.row(generator.uniform(0, kNumCentres));
  for (int d = 0; d < dimensions; ++d) points.col(d) *= 1.0 / (1.0 + 0.15 * d);
  return points;
}

/// Gives about a thousand words of 100,000 from the mixture.
constexpr double kMixtureRadius = 3.3;

/// `count` of the rows, at equal steps.
cv::Mat some_rows(const cv::Mat& rows, int count) {
  cv::Mat result;
  for (int i = 0; i < count; ++i) result.push_back(rows.row(static_cast<int>(static_cast<std::int64_t>(i) * rows.rows / count)));
  return result;
}

/// As if every word were compared with every descriptor in full.
void report_exhaustive_rate(benchmark::State& state, const cv::Mat& words, const cv::Mat& descriptors) {
  const double operations = 2.0 * static_cast<double>(words.rows) * descriptors.rows * words.cols;
  state.counters["exhaustive_GFLOP/s"] =
      benchmark::Counter(operations * 1e-9, benchmark::Counter::kIsIterationInvariantRate, benchmark::Counter::kIs1000);
}

/// Without any structure that a search could use.
void find_random_words(benchmark::State& state) {
  const int dimensions = 128;
  const Vocabulary vocabulary{random_descriptors(static_cast<int>(state.range(0)), dimensions, 5)};
  const cv::Mat descriptors = random_descriptors(static_cast<int>(state.range(1)), dimensions, 6);
  const WordFinder finder(vocabulary);
  for (auto _ : state) benchmark::DoNotOptimize(finder.nearest_words(descriptors));
  report_exhaustive_rate(state, vocabulary.words, descriptors);
}
BENCHMARK(find_random_words)
    ->Name("NearestWords/random")
    ->ArgNames({"words", "descriptors"})
    ->Args({1000, 1000})
    ->Args({10000, 1000})
    ->Unit(benchmark::kMillisecond);

void find_real_words(benchmark::State& state, WordSearch search) {
  const bench::RealDescriptors& real = bench::real_descriptors();
  if (real.words.empty()) {
    state.SkipWithError("the aerial images of ../shared/data are not here");
    return;
  }
  const cv::Mat descriptors = some_rows(real.queries, 1000);
  const WordFinder finder({real.words}, {search});
  std::vector<WordId> words;
  for (auto _ : state) benchmark::DoNotOptimize(words = finder.nearest_words(descriptors));
  const cv::Mat many = some_rows(real.queries, 10000);
  const std::vector<WordId> exact = nearest_words({real.words}, many), found = finder.nearest_words(many);
  double num_same = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) num_same += exact[i] == found[i] ? 1.0 : 0.0;
  state.counters["same_percent"] = 100.0 * num_same / static_cast<double>(exact.size());
  report_exhaustive_rate(state, real.words, descriptors);
}
BENCHMARK_CAPTURE(find_real_words, exact, WordSearch::Exact)->Name("NearestWords/rootsift/exact")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(find_real_words, approximate, WordSearch::Approximate)
    ->Name("NearestWords/rootsift/approximate")
    ->Unit(benchmark::kMillisecond);

void prepare_words(benchmark::State& state) {
  const Vocabulary vocabulary{random_mixture(static_cast<int>(state.range(0)), 128, 9)};
  for (auto _ : state) benchmark::DoNotOptimize(WordFinder(vocabulary));
}
BENCHMARK(prepare_words)->Name("WordFinder")->ArgName("words")->Arg(10000)->Unit(benchmark::kMillisecond);

void k_means(benchmark::State& state) {
  const cv::Mat descriptors = random_mixture(static_cast<int>(state.range(1)), 64, 7);
  KMeansOptions options;
  options.num_words = static_cast<std::size_t>(state.range(0));
  options.num_threads = 2;
  Vocabulary vocabulary;
  for (auto _ : state) vocabulary = train_k_means(descriptors, options);
  const std::vector<float> distances = nearest_rows(vocabulary.words, descriptors, 0).squared_distance;
  state.counters["mean_squared_distance"] = std::accumulate(distances.begin(), distances.end(), 0.0) / descriptors.rows;
}
BENCHMARK(k_means)
    ->Name("KMeans")
    ->ArgNames({"words", "descriptors"})
    ->Args({1000, 100000})
    ->Args({10000, 1000000})
    ->Iterations(1)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kSecond);

void radius_clustering(benchmark::State& state) {
  const cv::Mat descriptors = random_mixture(static_cast<int>(state.range(0)), 128, 10);
  RadiusClusteringOptions options;
  options.radius = kMixtureRadius;
  options.num_threads = 1;
  Vocabulary vocabulary;
  for (auto _ : state) vocabulary = train_radius_clustering(descriptors, options);
  state.counters["words"] = static_cast<double>(vocabulary.num_words());
}
BENCHMARK(radius_clustering)->Name("RadiusClustering")->ArgName("descriptors")->Arg(100000)->Unit(benchmark::kMillisecond);

/// A million descriptors in one image.
void observe_million(benchmark::State& state) {
  const WordFinder finder({random_mixture(1000, 64, 11)});
  const cv::Mat descriptors = random_mixture(1000000, 64, 12);
  for (auto _ : state) benchmark::DoNotOptimize(finder.observe(descriptors));
}
BENCHMARK(observe_million)->Name("ObserveMillion")->Iterations(1)->Unit(benchmark::kMillisecond);

/// 10,000 words of 128 numbers, their tree, and 1,000 observations of 300 words as background.
void load_model(benchmark::State& state) {
  const int num_words = static_cast<int>(state.range(0));
  const auto path = std::filesystem::temp_directory_path() / "fabloop_bench.fabmap";
  Model model;
  model.vocabulary.words = random_descriptors(num_words, 128, 8);
  model.tree = testing_support::random_tree(static_cast<std::size_t>(num_words), 0.03, 8);
  model.background = testing_support::TreeSampler(model.tree, 8).draw(1000);
  write_model(path, model);
  for (auto _ : state) benchmark::DoNotOptimize(read_model(path));
  state.counters["MB"] = static_cast<double>(std::filesystem::file_size(path)) * 1e-6;
  std::filesystem::remove(path);
}
BENCHMARK(load_model)->Name("LoadModel")->ArgName("words")->Arg(10000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fabloop
