// SPDX-License-Identifier: BSD-3-Clause
#include <iomanip>
#include <sstream>

#include "frontend/features/feature_report.h"

namespace fabloop {
namespace {

std::string fixed(double value, int decimals) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

std::string optional_text(const std::optional<double>& value, int decimals) { return value ? fixed(*value, decimals) : "n/a"; }

}  // namespace

std::string report_recipe(const FeatureReportOptions& options) {
  std::ostringstream text;
  text << "coverage: cells of a " << kCoverageColumns << " x " << kCoverageRows
       << " grid with a feature; matches: each other's nearest at a ratio of at most " << options.max_ratio
       << " between consecutive images; inliers: those that agree with their homography (RANSAC, " << options.max_error_px
       << " px, at least " << options.min_inliers
       << ", else the pair is not related); repeatability: share of an image's keypoints that, "
       << "carried into the next image by that homography, have one of its keypoints within " << options.max_error_px
       << " px with a size within a factor of " << options.max_size_ratio
       << " (what lies outside it does not count); time: median, one thread";
  return text.str();
}

std::string report_table(const std::vector<FeatureReport>& reports) {
  std::ostringstream text;
  text << "| features | mean | min | coverage | repeatability | related pairs | matches | inliers | ms |\n"
       << "|---|---|---|---|---|---|---|---|---|\n";
  for (const FeatureReport& report : reports) {
    text << "| " << to_string(report.kind) << " | " << fixed(report.mean_features, 0) << " | " << report.min_features << " | "
         << fixed(report.mean_coverage, 2) << " | " << optional_text(report.repeatability, 2) << " | " << report.num_related_pairs
         << "/" << report.num_pairs << " | " << fixed(report.mean_matches, 0) << " | " << fixed(report.mean_inliers, 0) << " | "
         << fixed(1e3 * report.median_time_s, 0) << " |\n";
  }
  return text.str();
}

std::string report_csv(const std::vector<FeatureReport>& reports) {
  std::ostringstream text;
  text << "features,images,mean_features,min_features,coverage,repeatability,pairs,related_pairs,matches,inliers,time_ms\n";
  for (const FeatureReport& report : reports) {
    text << to_string(report.kind) << ',' << report.num_images << ',' << fixed(report.mean_features, 1) << ','
         << report.min_features << ',' << fixed(report.mean_coverage, 4) << ','
         << (report.repeatability ? fixed(*report.repeatability, 4) : "") << ',' << report.num_pairs << ','
         << report.num_related_pairs << ',' << fixed(report.mean_matches, 1) << ',' << fixed(report.mean_inliers, 1) << ','
         << fixed(1e3 * report.median_time_s, 2) << '\n';
  }
  return text.str();
}

}  // namespace fabloop
