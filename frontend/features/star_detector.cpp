// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/features/star_detector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "frontend/features/octagon_sums.h"

namespace fabloop {
namespace {

/// The response at one scale; 0 where the filter does not fit into the image.
struct Layer {
  int radius = 0;  ///< Of the centre.
  int border = 0;  ///< Pixels at each edge where the filter does not fit.
  cv::Mat1f response;
};

/// For each pixel the scale at which the response is strongest.
struct BestScale {
  cv::Mat1f strength;
  cv::Mat1b index;
};

/// Radii of the centres: 1, 2, 3, 4, 6, 8, 12, ..., as long as the filter, of twice the radius, is at most so large.
std::vector<int> centre_radii(int max_size_px) {
  std::vector<int> radii;
  for (int power = 1; 4 * power + 1 <= max_size_px; power *= 2) {
    radii.push_back(power);
    if (power > 1 && 6 * power + 1 <= max_size_px) radii.push_back(power + power / 2);
  }
  return radii;
}

/// Mean of the centre less mean of the surround (Agrawal et al. 2008, section 3: the filter's values sum to zero, and its
/// response does not grow with its size).
Layer respond(const OctagonSums& sums, const cv::Size& size, int radius) {
  const Octagon centre(radius), whole(2 * radius);
  const double per_centre = 1.0 / centre.num_pixels, per_surround = 1.0 / (whole.num_pixels - centre.num_pixels);
  Layer layer{radius, whole.radius, cv::Mat1f(size, 0.0F)};
  for (int y = layer.border; y < size.height - layer.border; ++y) {
    float* row = layer.response[y];
    for (int x = layer.border; x < size.width - layer.border; ++x) {
      const std::uint32_t in_centre = sums.sum(centre, x, y);
      const std::uint32_t in_surround = sums.sum(whole, x, y) - in_centre;
      row[x] = static_cast<float>(in_centre * per_centre - in_surround * per_surround);
    }
  }
  return layer;
}

void keep_best(const Layer& layer, std::uint8_t index, BestScale& best) {
  for (int y = layer.border; y < layer.response.rows - layer.border; ++y) {
    const float* response = layer.response[y];
    for (int x = layer.border; x < layer.response.cols - layer.border; ++x) {
      const float strength = std::abs(response[x]);
      if (strength <= best.strength(y, x)) continue;
      best.strength(y, x) = strength;
      best.index(y, x) = index;
    }
  }
}

/// Whether no other response of its sign near (x, y) in the three layers is stronger; of equal ones the first has it.
bool is_extremum(const std::array<Layer, 3>& layers, int x, int y, int reach) {
  const float centre = layers[1].response(y, x);
  const float sign = centre < 0 ? -1.0F : 1.0F;
  const float strength = sign * centre;
  for (std::size_t l = 0; l < layers.size(); ++l) {
    for (int v = y - reach; v <= y + reach; ++v) {
      const float* row = layers[l].response[v];
      for (int u = x - reach; u <= x + reach; ++u) {
        const float other = sign * row[u];
        if (other < strength) continue;
        if (l == 1 && u == x && v == y) continue;
        const bool comes_earlier = l != 1 ? l < 1 : (v != y ? v < y : u < x);
        if (other > strength || comes_earlier) return false;
      }
    }
  }
  return true;
}

/// Whether an image changes in one direction only around (x, y): the ratio of the principal curvatures of its gradients'
/// second moments, by trace and determinant (Agrawal et al. 2008, section 3.4, after Harris), over a window that grows with
/// the scale. Where it does not change at all, it is no line.
template <typename Value>
bool is_line(const cv::Mat_<Value>& image, int border, int x, int y, int radius, double max_ratio) {
  constexpr int kReach = 4;
  const int step = std::max(1, radius / 2);
  const int edge = border + step;  // beyond it nothing is known
  double xx = 0, xy = 0, yy = 0;
  for (int j = -kReach; j <= kReach; ++j) {
    const int v = y + j * step;
    if (v < edge || v >= image.rows - edge) continue;
    for (int i = -kReach; i <= kReach; ++i) {
      const int u = x + i * step;
      if (u < edge || u >= image.cols - edge) continue;
      const double dx = static_cast<double>(image(v, u + step)) - image(v, u - step);
      const double dy = static_cast<double>(image(v + step, u)) - image(v - step, u);
      xx += dx * dx, xy += dx * dy, yy += dy * dy;
    }
  }
  const double trace = xx + yy, determinant = xx * yy - xy * xy;
  return trace > 0 && trace * trace >= max_ratio * determinant;
}

/// Where the parabola through three equidistant values has its extremum, from the middle one; within half a step.
double parabola_offset(double before, double middle, double after) {
  const double curvature = before - 2.0 * middle + after;
  return curvature == 0 ? 0.0 : std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5);
}

cv::KeyPoint refined(const std::array<Layer, 3>& layers, int x, int y, int index) {
  const cv::Mat1f& response = layers[1].response;
  const double dx = parabola_offset(response(y, x - 1), response(y, x), response(y, x + 1));
  const double dy = parabola_offset(response(y - 1, x), response(y, x), response(y + 1, x));
  const double ds = parabola_offset(layers[0].response(y, x), response(y, x), layers[2].response(y, x));
  const double neighbour = ds < 0 ? layers[0].radius : layers[2].radius;
  const double radius = layers[1].radius * std::pow(neighbour / layers[1].radius, std::abs(ds));
  return {static_cast<float>(x + dx),
          static_cast<float>(y + dy),
          static_cast<float>(2.0 * radius + 1.0),
          -1.0F,
          std::abs(response(y, x)),
          index};
}

void find_extrema(const std::array<Layer, 3>& layers, int index, const StarOptions& options, double threshold,
                  std::vector<cv::KeyPoint>& keypoints) {
  const cv::Mat1f& response = layers[1].response;
  const int reach = options.suppression_px / 2;
  const int border = layers[2].border + reach;
  for (int y = border; y < response.rows - border; ++y) {
    const float* row = response[y];
    for (int x = border; x < response.cols - border; ++x) {
      const float strength = std::abs(row[x]);
      if (strength == 0 || strength < threshold || !is_extremum(layers, x, y, reach)) continue;
      if (!is_line(response, layers[1].border, x, y, layers[1].radius, options.line_threshold))
        keypoints.push_back(refined(layers, x, y, index));
    }
  }
}

}  // namespace

std::vector<cv::KeyPoint> detect_star(const cv::Mat& gray, const StarOptions& options, double threshold) {
  const std::vector<int> radii = centre_radii(std::min({options.max_size_px, gray.cols, gray.rows}));
  if (radii.size() < 3) return {};
  const OctagonSums sums(gray);
  BestScale best{cv::Mat1f(gray.size(), 0.0F), cv::Mat1b(gray.size(), std::uint8_t{0})};
  std::vector<cv::KeyPoint> keypoints;
  std::array<Layer, 3> layers;  // only those that are compared are kept
  for (std::size_t i = 0; i < radii.size(); ++i) {
    std::rotate(layers.begin(), layers.begin() + 1, layers.end());
    layers[2] = respond(sums, gray.size(), radii[i]);
    keep_best(layers[2], static_cast<std::uint8_t>(i), best);
    if (i >= 2) find_extrema(layers, static_cast<int>(i) - 1, options, threshold, keypoints);
  }
  std::erase_if(keypoints, [&](const cv::KeyPoint& keypoint) {
    const int radius = radii[static_cast<std::size_t>(keypoint.octave)];
    return is_line(best.index, 2 * radius, static_cast<int>(std::lround(keypoint.pt.x)),
                   static_cast<int>(std::lround(keypoint.pt.y)), radius, options.line_threshold_scale);
  });
  return keypoints;
}

}  // namespace fabloop
