// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "data/world.h"
#include "frontend/geometry/camera.h"
#include "frontend/geometry/pose.h"

namespace fabloop {

/// What a camera sees, before its own faults (see photograph()).
struct RenderedView {
  cv::Mat3b image;  ///< BGR, camera.height x camera.width.
  cv::Mat1f depth;  ///< Metres along the camera's z axis; 0 where no ground is seen.
};

/// Draws views of a world through one camera, lens included. Keeps a reference to the world, which must outlive it.
/// Queries are const and safe in parallel.
class Renderer {
 public:
  /// Throws InputError when the camera is none.
  Renderer(const World& world, const Camera& camera);

  const Camera& camera() const { return camera_; }

  /// Image and depth from `world_from_camera`. Beyond the world's area the border's colours go on.
  RenderedView render(const Pose& world_from_camera) const;

 private:
  void render_row(int row, const Pose& world_from_camera, RenderedView& view) const;

  const World& world_;
  Camera camera_;
  std::vector<Eigen::Vector3d> rays_;  ///< Unit rays in the camera's frame, one a pixel, row by row.
};

}  // namespace fabloop
