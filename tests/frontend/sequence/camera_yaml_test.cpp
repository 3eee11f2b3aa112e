// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/camera_yaml.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>

#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(CameraYaml, ReadsRosCameraInfo) {
  const TemporaryFolder folder;
  const Camera camera = read_camera_yaml(folder.write("camera.yaml", kCameraYaml));
  EXPECT_EQ(camera.width, 64);
  EXPECT_EQ(camera.height, 48);
  EXPECT_EQ(camera.fx, 50.5);
  EXPECT_EQ(camera.fy, 51.5);
  EXPECT_EQ(camera.cx, 31.5);
  EXPECT_EQ(camera.cy, 23.5);
  EXPECT_EQ(camera.distortion_model, DistortionModel::Radtan);
  EXPECT_THAT(camera.distortion, ElementsAre(0.1, -0.2, 0.003, 0.004, 0.0));
}

TEST(CameraYaml, ReadsTheOtherDistortionModels) {
  const TemporaryFolder folder;
  const std::string head = "width: 64\r\nheight: 48\r\nK: [50, 0, 31.5, 0, 50, 23.5, 0, 0, 1]\r\n";
  const Camera fisheye =
      read_camera_yaml(folder.write("fisheye.yaml", head + "distortion_model: equidistant\r\nD: [0.1, 0.2, 0.3, 0.4]\r\n"));
  EXPECT_EQ(fisheye.distortion_model, DistortionModel::Equidistant);
  EXPECT_THAT(fisheye.distortion, ElementsAre(0.1, 0.2, 0.3, 0.4));
  const Camera rational = read_camera_yaml(
      folder.write("rational.yaml", head + "distortion_model: rational_polynomial\r\nD: [1, 2, 3, 4, 5, 6, 7, 8]\r\n"));
  EXPECT_EQ(rational.distortion_model, DistortionModel::Radtan);
  EXPECT_EQ(rational.distortion.size(), 8u);
}

TEST(CameraYaml, ReadsWhatOpenCvWrites) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "opencv.yml";
  {
    cv::FileStorage file(path.string(), cv::FileStorage::WRITE);
    const cv::Mat distortion = (cv::Mat_<double>(1, 14) << 0.1, -0.2, 0.003, 0.004, 0.5, 0, 0, 0, 0, 0, 0, 0, 0, 0);
    file << "image_width" << 64 << "image_height" << 48;
    file << "camera_matrix" << cv::Mat(cv::Matx33d(50.5, 0, 31.5, 0, 51.5, 23.5, 0, 0, 1)) << "distortion_coefficients"
         << distortion;
  }
  const Camera camera = read_camera_yaml(path);
  EXPECT_EQ(camera.fy, 51.5);
  EXPECT_EQ(camera.cx, 31.5);
  EXPECT_THAT(camera.distortion, ElementsAre(0.1, -0.2, 0.003, 0.004, 0.5, 0, 0, 0));
}

TEST(CameraYaml, ReadsKalibrAndEuroc) {
  const TemporaryFolder folder;
  const std::string body =
      "camera_model: pinhole, intrinsics: [50, 51, 31, 23], distortion_model: radtan, distortion_coeffs: [0.1, 0.2, 0, 0], "
      "resolution: [64, 48]";
  const Camera kalibr = read_camera_yaml(folder.write("camchain.yaml", "cam0: {" + body + "}\n"));
  EXPECT_EQ(kalibr.width, 64);
  EXPECT_EQ(kalibr.fy, 51);
  EXPECT_EQ(kalibr.cx, 31);
  EXPECT_THAT(kalibr.distortion, ElementsAre(0.1, 0.2, 0.0, 0.0));
  EXPECT_EQ(read_camera_yaml(folder.write("sensor.yaml", "{" + body + "}\n")).cy, 23);
}

TEST(CameraYaml, NamesWhatIsWrong) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& text) {
    const auto path = folder.write("bad.yaml", text);
    return input_error_of([&] { read_camera_yaml(path); });
  };
  const std::string size = "image_width: 64\nimage_height: 48\n";
  const std::string matrix = "camera_matrix: {data: [50, 0, 31, 0, 50, 23, 0, 0, 1]}\n";
  EXPECT_THAT(input_error_of([&] { read_camera_yaml(folder.path() / "absent.yaml"); }), HasSubstr("absent.yaml: cannot be read"));
  EXPECT_THAT(message(matrix), AllOf(HasSubstr("bad.yaml"), HasSubstr("image_width")));
  EXPECT_THAT(message(size), AllOf(HasSubstr("bad.yaml"), HasSubstr("camera_matrix")));
  EXPECT_THAT(message(size + "camera_matrix: {data: [1, 2]}\n"), AllOf(HasSubstr("bad.yaml:3"), HasSubstr("2 numbers, not 9")));
  EXPECT_THAT(message(size + "camera_matrix: {data: [50, 0, x, 0, 50, 23, 0, 0, 1]}\n"), HasSubstr("bad.yaml:3"));
  EXPECT_THAT(message(size + matrix + "distortion_model: omni\n"), AllOf(HasSubstr("bad.yaml:4"), HasSubstr("'omni'")));
  EXPECT_THAT(message(size + matrix + "distortion_coefficients: {data: [1, 2, 3]}\n"), HasSubstr("(3)"));
  EXPECT_THAT(message(size + "camera_matrix: {data: [50, 0, 31, 0, 50\n"), HasSubstr("bad.yaml:"));
  EXPECT_THAT(message("just text"), HasSubstr("is not a calibration"));
  EXPECT_THAT(message("image_width: 4\nimage_height: 4\n" + matrix), HasSubstr("principal point"));
}

}  // namespace
}  // namespace fabloop
