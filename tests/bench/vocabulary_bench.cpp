// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "frontend/fabmap/model.h"
#include "frontend/fabmap/vocabulary.h"
#include "frontend/fabmap/vocabulary_training.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

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

/// 10,000 words of 128 numbers, their tree, and 1,000 observations of 300 words as background.
void load_model(benchmark::State& state) {
  const int num_words = static_cast<int>(state.range(0));
  const auto path = std::filesystem::temp_directory_path() / "fabloop_bench.fabmap";
  Model model;
  model.vocabulary.words = random_descriptors(num_words, 128, 8);
  model.tree = testing::random_tree(static_cast<std::size_t>(num_words), 0.03, 8);
  model.background = testing::TreeSampler(model.tree, 8).draw(1000);
  write_model(path, model);
  for (auto _ : state) benchmark::DoNotOptimize(read_model(path));
  state.counters["MB"] = static_cast<double>(std::filesystem::file_size(path)) * 1e-6;
  std::filesystem::remove(path);
}
BENCHMARK(load_model)->Name("LoadModel")->ArgName("words")->Arg(10000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fabloop
