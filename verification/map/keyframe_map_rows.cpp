// SPDX-License-Identifier: BSD-3-Clause
#include "verification/map/keyframe_map_rows.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "frontend/error.h"
#include "frontend/features/features_bytes.h"
#include "frontend/state_bytes.h"

namespace fabloop::keyframe_map_rows {
namespace {

static_assert(std::endian::native == std::endian::little, "map files are read and written as they lie in memory");

/// A known point of a view's feature.
struct StoredPoint {
  std::uint64_t feature;
  double x, y, z, weight;
};

void require_end(const StateBytes& bytes) {
  if (!bytes.at_end()) throw StateDamaged();
}

}  // namespace

std::string row_of(const MapSession& session) {
  const Camera& camera = session.camera;
  StateBytes bytes;
  bytes.put(static_cast<std::int32_t>(camera.width));
  bytes.put(static_cast<std::int32_t>(camera.height));
  for (const double value : {camera.fx, camera.fy, camera.cx, camera.cy}) bytes.put(value);
  bytes.put(static_cast<std::int32_t>(camera.distortion_model));
  bytes.put(camera.distortion);
  bytes.put(session.body_from_camera);
  return bytes.bytes();
}

MapSession session_of(std::string_view row) {
  StateBytes bytes{std::string(row)};
  MapSession session;
  Camera& camera = session.camera;
  std::int32_t width = 0, height = 0, distortion_model = 0;
  bytes.take(width);
  bytes.take(height);
  for (double* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) bytes.take(*value);
  bytes.take(distortion_model);
  bytes.take(camera.distortion);
  bytes.take(session.body_from_camera);
  require_end(bytes);
  if (distortion_model < 0 || distortion_model > static_cast<std::int32_t>(DistortionModel::Equidistant)) throw StateDamaged();
  camera.width = width;
  camera.height = height;
  camera.distortion_model = static_cast<DistortionModel>(distortion_model);
  try {
    validate(camera, "camera");
  } catch (const InputError&) {
    throw StateDamaged();
  }
  return session;
}

std::string row_of(const MapKeyframe& keyframe) {
  StateBytes bytes;
  bytes.put(static_cast<std::uint64_t>(keyframe.view.frame));
  bytes.put(keyframe.time_ns);
  bytes.put(keyframe.odom_from_body);
  std::vector<double> covariance;
  if (keyframe.step_covariance) covariance.assign(keyframe.step_covariance->data(), keyframe.step_covariance->data() + 36);
  bytes.put(covariance);
  bytes.put(keyframe.view.height_above_ground.value_or(0.0));  // heights are positive
  bytes.put(keyframe.words.words);
  put(bytes, keyframe.view.features);
  return bytes.bytes();
}

MapKeyframe keyframe_of(std::string_view row, const Camera& camera) {
  StateBytes bytes{std::string(row)};
  MapKeyframe keyframe;
  std::uint64_t frame = 0;
  std::vector<double> covariance;
  bytes.take(frame);
  bytes.take(keyframe.time_ns);
  bytes.take(keyframe.odom_from_body);
  bytes.take(covariance);
  double height = 0;
  bytes.take(height);
  bytes.take(keyframe.words.words);
  Features features = take_features(bytes);
  require_end(bytes);
  if (covariance.size() == 36) {
    keyframe.step_covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6>>(covariance.data());
  } else if (!covariance.empty()) {
    throw StateDamaged();
  }
  keyframe.view = make_view(frame, camera, std::move(features));
  if (!(std::isfinite(height) && height >= 0.0)) throw StateDamaged();
  if (height > 0.0) keyframe.view.height_above_ground = height;
  return keyframe;
}

std::string points_row_of(const View& view) {
  std::vector<StoredPoint> points;
  for (std::size_t i = 0; i < view.points_in_camera.size(); ++i) {
    const auto& point = view.points_in_camera[i];
    if (point) points.push_back({i, point->x(), point->y(), point->z(), view.point_weights[i]});
  }
  StateBytes bytes;
  bytes.put(points);
  bytes.put(view.unit_sigma);
  return bytes.bytes();
}

void set_points(std::string_view row, View& view) {
  StateBytes bytes{std::string(row)};
  std::vector<StoredPoint> points;
  bytes.take(points);
  bytes.take(view.unit_sigma);
  require_end(bytes);
  if (!(std::isfinite(view.unit_sigma) && view.unit_sigma >= 0.0)) throw StateDamaged();
  for (const StoredPoint& point : points) {
    if (point.feature >= view.points_in_camera.size()) throw StateDamaged();
    view.points_in_camera[point.feature] = Eigen::Vector3d(point.x, point.y, point.z);
    view.point_weights[point.feature] = point.weight;
  }
}

}  // namespace fabloop::keyframe_map_rows
