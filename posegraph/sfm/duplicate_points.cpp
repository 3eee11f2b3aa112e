// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/duplicate_points.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdint>
#include <opencv2/flann.hpp>
#include <optional>
#include <utility>

#include "posegraph/sfm/track_triangulation.h"
#include "verification/chi_square.h"
#include "verification/median.h"

namespace fabloop {
namespace {

/// Features of one spot, as of two orientations, are no further apart (see Features::pixel_size).
constexpr double kSameSpotPx = 1.5;

/// Where a point is and how surely.
struct PointEstimate {
  std::uint32_t track = 0;
  Eigen::Vector3d x_in_world;
  Eigen::Matrix3d covariance;
  double reach = 0;  ///< Largest semi-axis of the ellipsoid that holds it.
};

/// Two estimates that may be of one point.
struct NearPair {
  double squared_distance = 0;          ///< Mahalanobis.
  std::uint32_t first = 0, second = 0;  ///< Tracks.
  auto operator<=>(const NearPair&) const = default;
};

/// Distance of two descriptors of one kind.
double descriptor_distance(const View& a, std::uint32_t feature_a, const View& b, std::uint32_t feature_b) {
  const cv::Mat& of_a = a.features.descriptors;
  const cv::Mat& of_b = b.features.descriptors;
  return cv::norm(of_a.row(static_cast<int>(feature_a)), of_b.row(static_cast<int>(feature_b)),
                  of_a.depth() == CV_8U ? cv::NORM_HAMMING : cv::NORM_L2);
}

class DuplicateSearch {
 public:
  DuplicateSearch(const std::vector<View>& views, TrackSet& tracks, Segment& segment, const DuplicatePointsOptions& options)
      : views_(views), tracks_(tracks), segment_(segment), options_(options), sigma_px_(noise_px()), alike_(usual_likeness()) {}

  std::size_t run() {
    std::size_t num_merged = 0;
    for (const NearPair& pair : pairs(estimates())) {
      if (!segment_.points[pair.first] || !segment_.points[pair.second]) continue;
      if (!are_seen_apart(pair) && look_alike(pair) && merge(pair)) ++num_merged;
    }
    if (num_merged > 0) index_views(tracks_, views_.size());
    return num_merged;
  }

 private:
  const Track& track(std::uint32_t t) const { return tracks_.tracks[t]; }
  Pose pose_of(const TrackFeature& member) const { return pose_at_sighting({views_, tracks_}, segment_, member); }
  Eigen::Vector2d pixel(const TrackFeature& member) const { return pixel_of({views_, tracks_}, member); }
  double error_px(const TrackFeature& member, const Eigen::Vector3d& x_in_world) const {
    return sighting_error_px({views_, tracks_}, segment_, member, x_in_world);
  }

  /// Standard deviation of a sighting along each axis of the image.
  double noise_px() const {
    constexpr double kMedianOfRayleigh = 1.17741;  // sqrt(2 ln 2)
    constexpr double kLeast = 0.05;
    std::vector<double> errors;
    for (std::uint32_t t = 0; t < segment_.points.size(); ++t) {
      if (!segment_.points[t]) continue;
      for (const std::uint32_t i : segment_.points[t]->seen_by)
        errors.push_back(error_px(track(t)[i], segment_.points[t]->x_in_world));
    }
    return errors.empty() ? kLeast : std::max(kLeast, median(std::move(errors)) / kMedianOfRayleigh);
  }

  /// The descriptors' distance that nine of ten neighbours in a track keep.
  double usual_likeness() const {
    constexpr double kShare = 0.9;
    constexpr std::size_t kEnough = 20'000;
    std::vector<double> distances;
    for (std::uint32_t t = 0; t < segment_.points.size() && distances.size() < kEnough; ++t) {
      if (!segment_.points[t]) continue;
      const auto& seen_by = segment_.points[t]->seen_by;
      for (std::size_t k = 1; k < seen_by.size(); ++k)
        distances.push_back(distance(track(t)[seen_by[k - 1]], track(t)[seen_by[k]]));
    }
    if (distances.empty()) return 0;
    const auto at = distances.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(distances.size() - 1));
    std::nth_element(distances.begin(), at, distances.end());
    return *at;
  }

  double distance(const TrackFeature& a, const TrackFeature& b) const {
    return descriptor_distance(views_[a.view], a.feature, views_[b.view], b.feature);
  }

  /// Each ray holds a point across, the more the nearer it is.
  std::optional<PointEstimate> estimate(std::uint32_t t) const {
    const SegmentPoint& point = *segment_.points[t];
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (const std::uint32_t i : point.seen_by) {
      const TrackFeature& member = track(t)[i];
      const Eigen::Vector3d to_point = point.x_in_world - pose_of(member).translation;
      const double weight = std::pow(feature_focal_px(views_[member.view]) / sigma_px_, 2) / to_point.squaredNorm();
      const Eigen::Vector3d ray = to_point.normalized();
      information += weight * (Eigen::Matrix3d::Identity() - ray * ray.transpose());
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(information);
    if (!(axes.eigenvalues()[0] > 0)) return std::nullopt;
    PointEstimate result{t, point.x_in_world, information.inverse(), 0};
    result.reach = std::sqrt(max_squared_distance_ / axes.eigenvalues()[0]);
    return result;
  }

  std::vector<PointEstimate> estimates() const {
    constexpr double kTooVague = 5.0;  // times the median
    std::vector<PointEstimate> result;
    std::vector<double> reaches;
    for (std::uint32_t t = 0; t < segment_.points.size(); ++t) {
      if (!segment_.points[t]) continue;
      if (const auto found = estimate(t)) {
        result.push_back(*found);
        reaches.push_back(found->reach);
      }
    }
    if (result.empty()) return result;
    const double most = kTooVague * median(std::move(reaches));
    std::erase_if(result, [&](const PointEstimate& point) { return point.reach > most; });
    return result;
  }

  /// Pairs within each other's reach, nearest first.
  std::vector<NearPair> pairs(const std::vector<PointEstimate>& points) const {
    std::vector<NearPair> result;
    if (points.size() < 2) return result;
    // Single precision holds coordinates about the middle.
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const PointEstimate& point : points) middle += point.x_in_world / static_cast<double>(points.size());
    cv::Mat1f rows(static_cast<int>(points.size()), 3);
    double longest = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis)
        rows(static_cast<int>(i), axis) = static_cast<float>((points[i].x_in_world - middle)[axis]);
      longest = std::max(longest, points[i].reach);
    }
    cv::flann::GenericIndex<cvflann::L2_Simple<float>> tree(rows, cvflann::KDTreeSingleIndexParams());
    std::vector<int> found(points.size());
    std::vector<float> distances(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::vector<float> query(rows.ptr<float>(static_cast<int>(i)), rows.ptr<float>(static_cast<int>(i)) + 3);
      const double radius = points[i].reach + longest;
      const int count =
          tree.radiusSearch(query, found, distances, static_cast<float>(radius * radius), cvflann::SearchParams(-1));
      for (int k = 0; k < std::min(count, static_cast<int>(found.size())); ++k) {
        const auto j = static_cast<std::size_t>(found[static_cast<std::size_t>(k)]);
        if (j <= i) continue;
        const Eigen::Vector3d apart = points[i].x_in_world - points[j].x_in_world;
        const Eigen::Matrix3d covariance = points[i].covariance + points[j].covariance;
        const double squared = apart.dot(covariance.ldlt().solve(apart));
        if (squared <= max_squared_distance_) result.push_back({squared, points[i].track, points[j].track});
      }
    }
    std::sort(result.begin(), result.end());
    return result;
  }

  /// Whether a view sees them at two spots, so that they are two.
  bool are_seen_apart(const NearPair& pair) const {
    for (const TrackFeature& member : track(pair.first)) {
      const auto other = position_in(track(pair.second), member.view);
      if (!other) continue;
      const double apart = (pixel(member) - pixel(track(pair.second)[*other])).norm();
      if (apart > kSameSpotPx * views_[member.view].features.pixel_size) return true;
    }
    return false;
  }

  bool look_alike(const NearPair& pair) const {
    for (const std::uint32_t i : segment_.points[pair.first]->seen_by) {
      for (const std::uint32_t j : segment_.points[pair.second]->seen_by) {
        if (distance(track(pair.first)[i], track(pair.second)[j]) <= alike_) return true;
      }
    }
    return false;
  }

  /// Makes them one where that explains every sighting.
  bool merge(const NearPair& pair) {
    std::vector<Eigen::Vector3d> centres, rays;
    std::vector<TrackFeature> sightings;
    for (const std::uint32_t t : {pair.first, pair.second}) {
      for (const std::uint32_t i : segment_.points[t]->seen_by) {
        const TrackFeature& member = track(t)[i];
        sightings.push_back(member);
        centres.push_back(pose_of(member).translation);
        rays.push_back(pose_of(member).rotation * views_[member.view].rays[member.feature]);
      }
    }
    const auto x_in_world = meeting_point(centres, rays);
    if (!x_in_world) return false;
    const auto is_off = [&](const TrackFeature& member) { return !(error_px(member, *x_in_world) <= options_.max_error_px); };
    if (std::any_of(sightings.begin(), sightings.end(), is_off)) return false;

    Track joined = track(pair.first);
    for (const TrackFeature& member : track(pair.second)) {
      if (!position_in(track(pair.first), member.view)) joined.push_back(member);
    }
    std::sort(joined.begin(), joined.end());
    SegmentPoint point{*x_in_world, {}};
    for (std::uint32_t i = 0; i < joined.size(); ++i) {
      if (segment_.world_from_cameras[joined[i].view] && !is_off(joined[i])) point.seen_by.push_back(i);
    }
    tracks_.tracks[pair.first] = std::move(joined);
    tracks_.tracks[pair.second].clear();
    segment_.points[pair.first] = std::move(point);
    segment_.points[pair.second].reset();
    return true;
  }

  const std::vector<View>& views_;
  TrackSet& tracks_;
  Segment& segment_;
  DuplicatePointsOptions options_;
  double max_squared_distance_ = chi_square_quantile(options_.probability, 3);
  double sigma_px_;
  double alike_;  ///< Descriptors of one point are no further apart.
};

}  // namespace

std::size_t merge_duplicate_points(const std::vector<View>& views, TrackSet& tracks, Segment& segment,
                                   const DuplicatePointsOptions& options) {
  return DuplicateSearch(views, tracks, segment, options).run();
}

}  // namespace fabloop
