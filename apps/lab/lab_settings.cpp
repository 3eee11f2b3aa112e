// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/lab_settings.h"

#include <array>

namespace fabloop {
namespace {

constexpr double kMuch = 1e6;

const std::array<LabParameter, 22> kParameters = {{
    {"aliasing", "share of a synthetic world's ground that is a copy of other ground", 0.0, 0.95, false, true,
     [](LabSettings& s) -> double& { return s.aliasing; }},
    {"drift", "factor on the errors of a synthetic world's odometry", 0.0, 10.0, false, false,
     [](LabSettings& s) -> double& { return s.drift; }},
    {"dropped_frames", "share of the frames that are missing", 0.0, 0.9, false, true,
     [](LabSettings& s) -> double& { return s.trouble.dropped_frames; }},
    {"blurred_frames", "share of the frames that are out of focus", 0.0, 1.0, false, true,
     [](LabSettings& s) -> double& { return s.trouble.blurred_frames; }},
    {"blur_px", "standard deviation of that blur, pixels", 0.1, 100.0, false, true,
     [](LabSettings& s) -> double& { return s.trouble.blur_px; }},
    {"exposed_frames", "share of the frames that are exposed wrongly", 0.0, 1.0, false, true,
     [](LabSettings& s) -> double& { return s.trouble.exposed_frames; }},
    {"exposure_stops", "by so many stops, too dark or too light by chance", 0.0, 8.0, false, true,
     [](LabSettings& s) -> double& { return s.trouble.exposure_stops; }},
    {"occluded_frames", "share of the frames of which a rectangle is covered", 0.0, 1.0, false, true,
     [](LabSettings& s) -> double& { return s.trouble.occluded_frames; }},
    {"occluded_area", "share of the picture that it covers", 0.0, 1.0, false, true,
     [](LabSettings& s) -> double& { return s.trouble.occluded_area; }},
    {"focal_error", "share by which the focal length is told too long", -0.9, 10.0, false, false,
     [](LabSettings& s) -> double& { return s.trouble.focal_error; }},
    {"odometry_translation_noise", "noise of each axis, as a share of the step", 0.0, 10.0, false, false,
     [](LabSettings& s) -> double& { return s.trouble.odometry_translation_noise; }},
    {"odometry_rotation_noise_deg", "noise of each axis at each step, degrees", 0.0, 90.0, false, false,
     [](LabSettings& s) -> double& { return s.trouble.odometry_rotation_noise_deg; }},
    {"odometry_slips", "share of the steps that slip", 0.0, 1.0, false, false,
     [](LabSettings& s) -> double& { return s.trouble.odometry_slips; }},
    {"slip_heading_deg", "largest turn of a slip, degrees", 0.0, 180.0, false, false,
     [](LabSettings& s) -> double& { return s.trouble.slip_heading_deg; }},
    {"random_false_loops", "share of the loops that are false ones added by chance", 0.0, 0.95, false, false,
     [](LabSettings& s) -> double& { return s.random_false_loops; }},
    {"grouped_false_loops", "share of the loops that are false ones added in groups that agree", 0.0, 0.95, false, false,
     [](LabSettings& s) -> double& { return s.grouped_false_loops; }},
    {"false_loop_group_size", "false loops in a group", 1.0, kMuch, true, false,
     [](LabSettings& s) -> double& { return s.false_loop_group_size; }},
    {"top", "places proposed for each query", 1.0, kMuch, true, false,
     [](LabSettings& s) -> double& { return s.top; }},
    {"window", "most recent places that are left out, and frames not judged", 0.0, kMuch, true, false,
     [](LabSettings& s) -> double& { return s.window; }},
    {"consistency", "other keyframes in a row that must confirm a loop; 0: none", 0.0, 100.0, true, false,
     [](LabSettings& s) -> double& { return s.consistency; }},
    {"min_inliers", "least inliers of a loop", 5.0, kMuch, true, false,
     [](LabSettings& s) -> double& { return s.min_inliers; }},
    {"inlier_probability", "of robust back ends: a right loop passes with this probability", 0.01, 0.999999, false, false,
     [](LabSettings& s) -> double& { return s.inlier_probability; }},
}};

}  // namespace

std::span<const LabParameter> lab_parameters() { return kParameters; }

const LabParameter* lab_parameter(std::string_view name) {
  for (const LabParameter& parameter : kParameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

}  // namespace fabloop
