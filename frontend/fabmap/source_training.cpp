// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/source_training.h"

#include <algorithm>
#include <string>

#include "frontend/fabmap/descriptor_spool.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

/// Images decoded at a time.
constexpr std::size_t kBlockSize = 16;

void describe(ImageSource& source, ImageShape shape, const ModelTrainingOptions& options, DescriptorSpool& spool) {
  const FeatureExtractor extractor(options.features);
  const std::string stage = "describing " + source.name();
  std::size_t done = 0;
  const auto report = [&](std::size_t total) {
    if (options.progress) options.progress(stage, done, total);
  };
  for (auto block = source.next(kBlockSize); !block.empty(); block = source.next(kBlockSize)) {
    std::vector<cv::Mat> descriptors(block.size());
    parallel_for(block.size(), options.num_threads,
                 [&](std::size_t i) { descriptors[i] = extract(extractor, block[i].gray, shape).descriptors; });
    for (const cv::Mat& of_image : descriptors) spool.add(of_image);
    done += block.size();
    report(std::max(done, source.estimated_size().value_or(done + 1)));
  }
  report(done);
}

}  // namespace

TrainedModel train_model(std::vector<ImageSource>& sources, const SourceTrainingOptions& source_options,
                         const ModelTrainingOptions& options) {
  DescriptorSpool spool(source_options.spool);
  for (ImageSource& source : sources) describe(source, source_options.shape, options, spool);
  const FeatureSource features = [&](std::size_t image) { return Features{options.features.kind, {}, spool.read(image)}; };
  return train_model(spool.size(), features, options);
}

}  // namespace fabloop
