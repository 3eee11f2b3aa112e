// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "frontend/features/feature_extractor.h"
#include "verification/matching/matching.h"

namespace fabloop {
namespace {

/// The two images whose features are matched: they overlap by half.
struct FeaturePair {
  Features query, match;
};

/// The strongest of a set.
Features first(const Features& features, int count) {
  Features result = features;
  if (features.descriptors.rows <= count) return result;
  result.keypoints.resize(static_cast<std::size_t>(count));
  result.descriptors = features.descriptors.rowRange(0, count).clone();
  return result;
}

FeaturePair extract_pair(DetectorKind detector, DescriptorKind descriptor) {
  const std::filesystem::path folder = std::filesystem::path(FABLOOP_SHARED_DATA_DIR) / "aerial" / "sheffield_cross" / "images";
  std::vector<std::filesystem::path> images;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) images.push_back(entry.path());
  if (images.size() < 13) return {};
  std::sort(images.begin(), images.end());
  FeatureOptions options;
  options.kind = {detector, descriptor};
  options.max_features = 4000;
  options.detection_threshold = detector == DetectorKind::Sift ? std::optional(0.005) : std::optional(2.0);
  if (detector == DetectorKind::Akaze) options.detection_threshold = 1e-4;
  const FeatureExtractor extractor(options);
  const auto look = [&](std::size_t i) { return extractor.extract(cv::imread(images[i].string(), cv::IMREAD_GRAYSCALE)); };
  return {look(10), look(12)};
}

/// `count` features of each image; skips where the images are absent or too poor.
FeaturePair real_pair(benchmark::State& state, DetectorKind detector, DescriptorKind descriptor, int count) {
  static std::map<std::pair<DetectorKind, DescriptorKind>, FeaturePair> known;
  const auto [place, is_new] = known.try_emplace({detector, descriptor});
  if (is_new) place->second = extract_pair(detector, descriptor);
  FeaturePair pair{first(place->second.query, count), first(place->second.match, count)};
  if (pair.query.descriptors.rows < count || pair.match.descriptors.rows < count) {
    state.SkipWithError("the aerial images of ../shared/data are not here, or have fewer features");
  }
  return pair;
}

void match_approximately(benchmark::State& state, DetectorKind detector, DescriptorKind descriptor) {
  const FeaturePair pair = real_pair(state, detector, descriptor, static_cast<int>(state.range(0)));
  std::vector<Match> matches;
  for (auto _ : state) {
    benchmark::DoNotOptimize(matches = match_features(pair.query, pair.match, {.search = MatchSearch::Approximate}));
  }
  state.counters["matches"] = static_cast<double>(matches.size());
}

void match_ours(benchmark::State& state, DetectorKind detector, DescriptorKind descriptor) {
  const FeaturePair pair = real_pair(state, detector, descriptor, static_cast<int>(state.range(0)));
  std::vector<Match> matches;
  for (auto _ : state) benchmark::DoNotOptimize(matches = match_features(pair.query, pair.match));
  state.counters["matches"] = static_cast<double>(matches.size());
}

/// Two nearest neighbours both ways, the ratio test, and only what agrees.
void match_opencv(benchmark::State& state, DetectorKind detector, DescriptorKind descriptor) {
  const FeaturePair pair = real_pair(state, detector, descriptor, static_cast<int>(state.range(0)));
  const cv::BFMatcher matcher(pair.query.descriptors.type() == CV_32F ? cv::NORM_L2 : cv::NORM_HAMMING);
  std::size_t num_matches = 0;
  for (auto _ : state) {
    std::vector<std::vector<cv::DMatch>> forward, backward;
    matcher.knnMatch(pair.query.descriptors, pair.match.descriptors, forward, 2);
    matcher.knnMatch(pair.match.descriptors, pair.query.descriptors, backward, 1);
    num_matches = 0;
    for (const auto& two : forward) {
      const bool is_distinct = two.size() == 2 && two[0].distance <= MatchingOptions{}.max_ratio * two[1].distance;
      if (is_distinct && backward[static_cast<std::size_t>(two[0].trainIdx)][0].trainIdx == two[0].queryIdx) ++num_matches;
    }
  }
  state.counters["matches"] = static_cast<double>(num_matches);
}

#define FABLOOP_MATCHING_BENCH(function, name, detector, descriptor)                    \
  BENCHMARK_CAPTURE(function, name, DetectorKind::detector, DescriptorKind::descriptor) \
      ->Name("Matching/" #name "/" #function)                                           \
      ->Arg(1000)                                                                       \
      ->Arg(2000)                                                                       \
      ->Arg(4000)                                                                       \
      ->Unit(benchmark::kMillisecond)
FABLOOP_MATCHING_BENCH(match_ours, sift, Sift, Sift);
FABLOOP_MATCHING_BENCH(match_approximately, sift, Sift, Sift);
FABLOOP_MATCHING_BENCH(match_opencv, sift, Sift, Sift);
FABLOOP_MATCHING_BENCH(match_ours, orb, Orb, Orb);
FABLOOP_MATCHING_BENCH(match_opencv, orb, Orb, Orb);
FABLOOP_MATCHING_BENCH(match_ours, akaze, Akaze, Akaze);
FABLOOP_MATCHING_BENCH(match_opencv, akaze, Akaze, Akaze);
#undef FABLOOP_MATCHING_BENCH

}  // namespace
}  // namespace fabloop
