// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/feature_options.h"

#include <cmath>
#include <sstream>
#include <string>

#include "frontend/error.h"

namespace fabloop {
namespace {

constexpr int kMostFeatures = 1'000'000;

std::string text_of(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

void require(const std::string& name, double value, double least, double most) {
  if (value >= least && value <= most) return;  // which NaN fails
  throw InputError("feature options: " + name + " is " + text_of(value) + "; give " + text_of(least) + " to " + text_of(most));
}

void require_positive(const std::string& name, const std::optional<double>& value, const std::string& otherwise) {
  if (!value || (*value > 0 && std::isfinite(*value))) return;
  throw InputError("feature options: " + name + " is " + text_of(*value) + "; give a positive number, or " + otherwise);
}

void validate(const FeatureOptions& options, const AdaptiveOptions& adaptive) {
  require("adaptive.min_features", adaptive.min_features, 1, kMostFeatures);
  require("adaptive.max_features", adaptive.max_features, adaptive.min_features, kMostFeatures);
  require("adaptive.max_iterations", adaptive.max_iterations, 1, 100);
  require("adaptive.min_threshold_ratio", adaptive.min_threshold_ratio, 1e-6, 1.0);
  if (adaptive.min_features > options.max_features) {
    throw InputError("feature options: adaptive.min_features is " + std::to_string(adaptive.min_features) +
                     ", more than max_features (" + std::to_string(options.max_features) + "); raise max_features");
  }
}

void validate_scale_spaces(const FeatureOptions& options) {
  require("sift.layers_per_octave", options.sift.layers_per_octave, 1, 20);
  require("sift.edge_threshold", options.sift.edge_threshold, 1, 1e6);
  require("sift.sigma", options.sift.sigma, 0.6, 20);
  require("surf.num_octaves", options.surf.num_octaves, 1, 8);
  require("surf.layers_per_octave", options.surf.layers_per_octave, 1, 10);
  require("orb.scale_factor", options.orb.scale_factor, 1.01, 4);
  require("orb.num_levels", options.orb.num_levels, 1, 32);
  require("orb.patch_size_px", options.orb.patch_size_px, 5, 255);
  require("brisk.num_octaves", options.brisk.num_octaves, 0, 8);
  require("brisk.pattern_scale", options.brisk.pattern_scale, 0.1, 10);
  require("akaze.num_octaves", options.akaze.num_octaves, 1, 8);
  require("akaze.layers_per_octave", options.akaze.layers_per_octave, 1, 10);
  require("kaze.num_octaves", options.kaze.num_octaves, 1, 8);
  require("kaze.layers_per_octave", options.kaze.layers_per_octave, 1, 10);
}

void validate_single_scales(const FeatureOptions& options) {
  require("star.max_size_px", options.star.max_size_px, 17, 1025);
  require("star.line_threshold", options.star.line_threshold, 4, 1e6);
  require("star.line_threshold_scale", options.star.line_threshold_scale, 4, 1e6);
  require("star.suppression_px", options.star.suppression_px, 3, 99);
  require("mser.delta", options.mser.delta, 1, 255);
  require("mser.min_area_px", options.mser.min_area_px, 5, 1e9);
  require("mser.max_area_px", options.mser.max_area_px, options.mser.min_area_px, 1e9);
  require("mser.max_variation", options.mser.max_variation, 1e-6, 1e6);
  require("mser.min_diversity", options.mser.min_diversity, 0, 1);
  require("gftt.min_distance_px", options.gftt.min_distance_px, 0, 1e6);
  require("gftt.block_size_px", options.gftt.block_size_px, 1, 31);
}

}  // namespace

double default_detection_threshold(DetectorKind kind) {
  switch (kind) {
    case DetectorKind::Sift:
      return 0.01;
    case DetectorKind::Surf:
      return 50;
    case DetectorKind::Star:
      return 4;
    case DetectorKind::Mser:
      return 4;
    case DetectorKind::Orb:
      return 7;
    case DetectorKind::Brisk:
      return 12;
    case DetectorKind::Akaze:
      return 1e-4;
    case DetectorKind::Kaze:
      return 1e-4;
    case DetectorKind::Fast:
    case DetectorKind::Agast:
      return 10;
    case DetectorKind::Gftt:
      return 0.005;
  }
  return 0;
}

double detection_threshold(const FeatureOptions& options) {
  return options.detection_threshold.value_or(default_detection_threshold(options.kind.detector));
}

void validate(const FeatureOptions& options) {
  require_sensible(options.kind);
  require("max_features", options.max_features, 1, kMostFeatures);
  require("max_side_px", options.max_side_px, kLeastSidePx, kLargestSidePx);
  if (options.detection_threshold) require("detection_threshold", *options.detection_threshold, 0, 1e9);
  require_positive("clahe_clip_limit", options.clahe_clip_limit, "none to leave images as they are");
  if (options.adaptive) validate(options, *options.adaptive);
  validate_scale_spaces(options);
  validate_single_scales(options);
  if (options.star.suppression_px % 2 == 0)
    throw InputError("feature options: star.suppression_px is " + std::to_string(options.star.suppression_px) +
                     "; give an odd number");
  const bool is_brisk = options.kind.descriptor == DescriptorKind::Brisk;
  if (is_brisk && options.orientation == Orientation::Upright) {
    throw InputError("feature options: orientation is upright, but brisk always turns; give another descriptor, or dominant");
  }
}

}  // namespace fabloop
