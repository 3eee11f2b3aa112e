// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/readout_equations.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "posegraph/residuals/reprojection_cost.h"
#include "posegraph/robust_loss.h"
#include "verification/median.h"

namespace fabloop {
namespace {

constexpr int kViewSize = bundle::kViewSize;
constexpr int kNumUnknowns = ReadoutVector::RowsAtCompileTime, kNumOfCalibration = kNumUnknowns - 1;
using ViewBlock = Eigen::Matrix<double, kViewSize, kViewSize>;
using ViewByUnknowns = Eigen::Matrix<double, kViewSize, kNumUnknowns>;
using PointByUnknowns = Eigen::Matrix<double, 3, kNumUnknowns>;

/// A sighting's error and its derivatives, times the root of its robust weight.
struct LinearSighting {
  std::size_t view = 0;  ///< Among the numbered.
  Eigen::Vector2d error = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, kViewSize> by_view = Eigen::Matrix<double, 2, kViewSize>::Zero();
  Eigen::Matrix<double, 2, 3> by_point = Eigen::Matrix<double, 2, 3>::Zero();
  Eigen::Matrix<double, 2, kNumUnknowns> by_unknowns = Eigen::Matrix<double, 2, kNumUnknowns>::Zero();
  double px_per_s = 0;
};

/// How a pinhole's sighting of (x, y, 1) moves when the calibration is off, in the order of the unknowns.
Eigen::Matrix<double, 2, kNumOfCalibration> by_calibration(double x, double y, double r2) {
  Eigen::Matrix<double, 2, kNumOfCalibration> result;
  result << 0, y, x, 1, 0, x * r2, 2 * x * y, r2 + 2 * x * x,  //
      y, 0, y, 0, 1, y * r2, r2 + 2 * y * y, 2 * x * y;
  return result;
}

/// Members of a point's track in those views.
std::vector<TrackFeature> members_in(const Scene& scene, const Segment& segment, std::size_t track,
                                     const std::vector<char>& takes_part) {
  std::vector<TrackFeature> members;
  if (!segment.points[track]) return members;
  for (const std::uint32_t i : segment.points[track]->seen_by) {
    const TrackFeature& member = scene.tracks.tracks[track][i];
    if (takes_part[member.view]) members.push_back(member);
  }
  return members;
}

/// Placed views that see enough points for a pose, of points that another of them sees, too.
std::vector<char> views_that_see_enough(const Scene& scene, const Segment& segment) {
  constexpr std::size_t kLeastPoints = 6;  // three would do for a pose, but not to say how well it fits
  std::vector<char> takes_part(scene.views.size(), 0);
  for (std::size_t view = 0; view < scene.views.size(); ++view) takes_part[view] = segment.world_from_cameras[view].has_value();
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    std::vector<std::size_t> num_points(scene.views.size(), 0);
    for (std::size_t track = 0; track < segment.points.size(); ++track) {
      const std::vector<TrackFeature> members = members_in(scene, segment, track, takes_part);
      if (members.size() < 2) continue;
      for (const TrackFeature& member : members) ++num_points[member.view];
    }
    for (std::size_t view = 0; view < scene.views.size(); ++view) {
      if (!takes_part[view] || num_points[view] >= kLeastPoints) continue;
      takes_part[view] = 0;
      has_changed = true;
    }
  }
  return takes_part;
}

/// Poses and points eliminated exactly.
class Elimination {
 public:
  Elimination(const Scene& scene, const Segment& segment, const std::vector<CameraRate>& rates, double loss_px)
      : scene_(scene),
        segment_(segment),
        rates_(rates),
        loss_px_(loss_px),
        number_of_(scene.views.size(), 0),
        takes_part_(views_that_see_enough(scene, segment)) {
    for (std::size_t view = 0; view < scene.views.size(); ++view) {
      turned_.emplace_back(segment.world_from_cameras[view] ? segment.world_from_cameras[view]->rotation.normalized()
                                                            : Eigen::Quaterniond::Identity());
      if (!takes_part_[view]) continue;
      number_of_[view] = num_views_++;
      centres_.push_back(segment.world_from_cameras[view]->translation);
    }
  }

  ReadoutEquations run() {
    reduce();
    if (!solve_views()) return {};
    score();
    equations_.px_per_s = median(std::move(px_per_s_));
    return std::move(equations_);
  }

 private:
  /// None of a point behind the camera.
  std::optional<LinearSighting> linear(const SegmentPoint& point, const TrackFeature& member) {
    const View& view = scene_.views[member.view];
    const Eigen::Vector2d pixel = pixel_of(scene_, member);
    const double share = readout_share(view.camera, pixel.y());
    const ReadoutMotion motion = segment_.readout_motions.empty() ? ReadoutMotion{} : segment_.readout_motions[member.view];
    const Eigen::Vector3d& ray = view.rays[member.feature];
    const bundle::PinholeError cost(turned_[member.view], view.camera, view.features.pixel_size, ray, motion, share);
    LinearSighting result;
    result.view = number_of_[member.view];
    Eigen::Matrix<double, kViewSize, 1> block = Eigen::Matrix<double, kViewSize, 1>::Zero();
    block.tail<3>() = centres_[result.view];
    Eigen::Matrix<double, 2, kViewSize, Eigen::RowMajor> by_view;
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
    const std::array<const double*, 2> blocks{block.data(), point.x_in_world.data()};
    std::array<double*, 2> derivatives{by_view.data(), by_point.data()};
    if (!cost.Evaluate(blocks.data(), result.error.data(), derivatives.data())) return std::nullopt;
    // A row at `share` sees the camera moved on by its rate times share times readout: the derivative is that by the pose.
    Eigen::Matrix<double, kViewSize, 1> rate;
    rate << rates_[member.view].turn_per_s, rates_[member.view].velocity_in_world_per_s;
    const Eigen::Vector2d per_readout = by_view * rate;
    result.px_per_s = view.features.pixel_size * per_readout.norm();
    const double x = ray.x() / ray.z();
    const double y = ray.y() / ray.z();
    const double r2 = x * x + y * y;
    result.by_unknowns << share * per_readout, by_calibration(x, y, r2);
    result.by_unknowns.rightCols<kNumOfCalibration>() *= view.camera.focal_px() / view.features.pixel_size;
    const double root_weight = std::sqrt(robust_weight(RobustLoss::Cauchy, result.error.squaredNorm(), loss_px_ * loss_px_));
    result.error *= root_weight;
    result.by_view = root_weight * by_view;
    result.by_point = root_weight * by_point;
    result.by_unknowns *= root_weight;
    return result;
  }

  std::vector<LinearSighting> sightings_of(std::size_t track) {
    std::vector<LinearSighting> sightings;
    for (const TrackFeature& member : members_in(scene_, segment_, track, takes_part_)) {
      if (const auto sighting = linear(*segment_.points[track], member)) sightings.push_back(*sighting);
    }
    return sightings;
  }

  static std::optional<Eigen::Matrix3d> covariance_of_point(const std::vector<LinearSighting>& sightings) {
    if (sightings.size() < 2) return std::nullopt;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (const LinearSighting& s : sightings) information += s.by_point.transpose() * s.by_point;
    const Eigen::LDLT<Eigen::Matrix3d> solver(information);
    if (!(solver.vectorD().minCoeff() > 0)) return std::nullopt;
    return solver.solve(Eigen::Matrix3d::Identity());
  }

  /// Normal equations of the views, points eliminated.
  void reduce() {
    right_.assign(num_views_, ViewByUnknowns::Zero());
    for (std::size_t track = 0; track < segment_.points.size(); ++track) {
      const std::vector<LinearSighting> sightings = sightings_of(track);
      const auto covariance = covariance_of_point(sightings);
      if (!covariance) continue;
      PointByUnknowns point_by_unknowns = PointByUnknowns::Zero();
      for (const LinearSighting& s : sightings) point_by_unknowns += s.by_point.transpose() * s.by_unknowns;
      for (const LinearSighting& a : sightings) {
        const Eigen::Matrix<double, kViewSize, 3> gain = a.by_view.transpose() * a.by_point * *covariance;
        right_[a.view] += a.by_view.transpose() * a.by_unknowns - gain * point_by_unknowns;
        blocks_.try_emplace({a.view, a.view}, ViewBlock::Zero()).first->second += a.by_view.transpose() * a.by_view;
        for (const LinearSighting& b : sightings) {
          if (b.view > a.view) continue;
          blocks_.try_emplace({a.view, b.view}, ViewBlock::Zero()).first->second -= gain * b.by_point.transpose() * b.by_view;
        }
        px_per_s_.push_back(a.px_per_s);
      }
    }
  }

  /// How the views follow the unknowns. The first view is held, and its distance to the farthest, since the world's place and
  /// unit are free.
  bool solve_views() {
    if (num_views_ < 2) return false;
    std::size_t farthest = 1;
    for (std::size_t view = 2; view < num_views_; ++view) {
      if ((centres_[view] - centres_[0]).norm() > (centres_[farthest] - centres_[0]).norm()) farthest = view;
    }
    const Eigen::Vector3d away = (centres_[farthest] - centres_[0]).normalized();
    const auto of_itself = blocks_.find({farthest, farthest});
    if (of_itself == blocks_.end()) return false;
    ViewBlock& of_farthest = of_itself->second;
    const Eigen::Matrix3d hold = of_farthest.bottomRightCorner<3, 3>().trace() * away * away.transpose();
    of_farthest.bottomRightCorner<3, 3>() += hold;
    const auto size = static_cast<Eigen::Index>(kViewSize * (num_views_ - 1));
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& [at, block] : blocks_) {
      if (at.first == 0 || at.second == 0) continue;
      for (int row = 0; row < kViewSize; ++row) {
        for (int column = 0; column < kViewSize; ++column) {
          entries.emplace_back(static_cast<int>(kViewSize * (at.first - 1)) + row,
                               static_cast<int>(kViewSize * (at.second - 1)) + column, block(row, column));
        }
      }
    }
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::Matrix<double, Eigen::Dynamic, kNumUnknowns> right(size, kNumUnknowns);
    for (std::size_t view = 1; view < num_views_; ++view) right.middleRows<kViewSize>(offset(view)) = right_[view];
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver(matrix);
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0)) return false;
    const Eigen::Matrix<double, Eigen::Dynamic, kNumUnknowns> follow = solver.solve(right);
    follow_.assign(num_views_, ViewByUnknowns::Zero());
    for (std::size_t view = 1; view < num_views_; ++view) follow_[view] = follow.middleRows<kViewSize>(offset(view));
    return true;
  }

  static Eigen::Index offset(std::size_t view) { return static_cast<Eigen::Index>(kViewSize * (view - 1)); }

  /// Information and scores of the unknowns by view, with what views and points take up of them taken away.
  void score() {
    equations_.score.assign(num_views_, ReadoutVector::Zero());
    equations_.information.assign(num_views_, ReadoutMatrix::Zero());
    for (std::size_t track = 0; track < segment_.points.size(); ++track) {
      std::vector<LinearSighting> sightings = sightings_of(track);
      const auto covariance = covariance_of_point(sightings);
      if (!covariance) continue;
      PointByUnknowns of_point = PointByUnknowns::Zero();
      for (LinearSighting& s : sightings) {
        s.by_unknowns -= s.by_view * follow_[s.view];
        of_point += s.by_point.transpose() * s.by_unknowns;
      }
      of_point = *covariance * of_point;
      for (LinearSighting& s : sightings) {
        s.by_unknowns -= s.by_point * of_point;
        equations_.score[s.view] += s.by_unknowns.transpose() * s.error;
        equations_.information[s.view] += s.by_unknowns.transpose() * s.by_unknowns;
      }
    }
  }

  const Scene& scene_;
  const Segment& segment_;
  const std::vector<CameraRate>& rates_;
  double loss_px_;
  std::deque<bundle::TurnedView> turned_;  ///< One a view of the scene.
  std::vector<std::size_t> number_of_;     ///< Of each view of the scene that takes part: its position among those.
  std::vector<char> takes_part_;           ///< One a view of the scene.
  std::size_t num_views_ = 0;
  std::vector<Eigen::Vector3d> centres_;                             ///< Of the numbered.
  std::map<std::pair<std::size_t, std::size_t>, ViewBlock> blocks_;  ///< Lower triangle.
  std::vector<ViewByUnknowns> right_, follow_;
  std::vector<double> px_per_s_;  ///< One a sighting.
  ReadoutEquations equations_;
};

}  // namespace

ReadoutEquations readout_equations(const Scene& scene, const Segment& segment, const std::vector<CameraRate>& rates,
                                   double loss_px) {
  return Elimination(scene, segment, rates, loss_px).run();
}

}  // namespace fabloop
