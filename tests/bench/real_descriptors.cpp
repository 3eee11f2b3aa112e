// SPDX-License-Identifier: BSD-3-Clause
#include "tests/bench/real_descriptors.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "frontend/fabmap/vocabulary_training.h"
#include "frontend/features/feature_extractor.h"
#include "frontend/parallel.h"

namespace fabloop::bench {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> aerial_images() {
  std::vector<fs::path> paths;
  const fs::path folder = fs::path(FABLOOP_SHARED_DATA_DIR) / "aerial";
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    if (entry.path().extension() == ".jpg") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

RealDescriptors make() {
  constexpr std::size_t kNumImages = 70, kQueryEvery = 7;
  const std::vector<fs::path> all = aerial_images();
  RealDescriptors result;
  if (all.size() < kNumImages) return result;
  FeatureOptions options;
  options.max_features = 2000;
  const FeatureExtractor extractor(options);
  std::vector<cv::Mat> descriptors(kNumImages);
  parallel_for(kNumImages, 0, [&](std::size_t i) {
    descriptors[i] = extractor.extract(cv::imread(all[i * all.size() / kNumImages].string(), cv::IMREAD_GRAYSCALE)).descriptors;
  });
  cv::Mat training;
  for (std::size_t i = 0; i < kNumImages; ++i) (i % kQueryEvery == 0 ? result.queries : training).push_back(descriptors[i]);
  KMeansOptions k_means;
  k_means.num_words = 10000;
  result.words = train_k_means(training, k_means).words;
  return result;
}

}  // namespace

const RealDescriptors& real_descriptors() {
  static const RealDescriptors result = make();
  return result;
}

}  // namespace fabloop::bench
