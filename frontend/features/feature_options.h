// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "frontend/features/feature_kind.h"

namespace fabloop {

/// SIFT's scale space.
struct SiftOptions {
  int layers_per_octave = 3;     ///< More finds more, and is slower.
  double edge_threshold = 10.0;  ///< Largest ratio of principal curvatures: higher keeps more of what lies along edges.
  double sigma = 1.6;            ///< Blur of the first layer [px]. Less for blurred images.
};

/// SURF's filters.
struct SurfOptions {
  int num_octaves = 4;        ///< Each doubles the size: more finds larger blobs.
  int layers_per_octave = 4;  ///< Scales of an octave in which maxima are looked for.
};

/// STAR's filters and line suppression.
struct StarOptions {
  int max_size_px = 65;               ///< Diameter of the largest filter; blobs up to about a third of it are found.
  double line_threshold = 10.0;       ///< Largest ratio tr^2 / det of the response's gradients: higher keeps more of lines.
  double line_threshold_scale = 8.0;  ///< The same of the best scale's.
  int suppression_px = 3;             ///< Width of the window in which an extremum must be the only one; odd.
};

/// MSER's regions.
struct MserOptions {
  int delta = 5;                ///< Grey levels over which a region must be stable: more finds fewer.
  int min_area_px = 60;         ///< Smallest region.
  int max_area_px = 14400;      ///< Largest region.
  double max_variation = 0.25;  ///< Largest relative growth over delta that is stable: less finds fewer.
  double min_diversity = 0.2;   ///< Least relative difference between regions inside one another.
};

/// ORB's pyramid.
struct OrbOptions {
  double scale_factor = 1.2;  ///< Between levels of the pyramid.
  int num_levels = 8;
  int patch_size_px = 31;  ///< Of the descriptor, at its level; as much at the image's edge gives no features.
};

/// BRISK's scale space.
struct BriskOptions {
  int num_octaves = 3;         ///< 0: one scale.
  double pattern_scale = 1.0;  ///< Of the sampling pattern: more describes a larger patch.
};

/// AKAZE's and KAZE's scale space.
struct KazeOptions {
  int num_octaves = 4;
  int layers_per_octave = 4;
};

/// FAST and AGAST.
struct CornerOptions {
  bool non_max_suppression = true;  ///< False gives clusters of corners.
};

/// Corners by eigenvalue.
struct GfttOptions {
  double min_distance_px = 3.0;  ///< Between corners.
  int block_size_px = 3;         ///< Over which gradients are summed: more for noisy images.
};

/// Steers the threshold of each image to a wanted number of features.
struct AdaptiveOptions {
  int min_features = 300;
  int max_features = 500;
  int max_iterations = 10;           ///< Only for ORB and AGAST, which look anew for each threshold.
  double min_threshold_ratio = 0.1;  ///< The lowest threshold as a share of the given one: where poor texture ends.
};

/// Whether features turn with the image.
enum class Orientation {
  Dominant,  ///< Described along the dominant gradient: found again from another heading.
  Upright,   ///< Described as they stand: more distinctive, and faster, where the camera never rolls (a robot's).
};

constexpr int kLeastSidePx = 64;
constexpr int kLargestSidePx = 100'000;  ///< Images as they are.

/// What to detect, how much of it, and how the image is prepared.
struct FeatureOptions {
  /// SIFT finds the most true matches on low-contrast ground; ORB is several times faster and its descriptors 16 times smaller.
  FeatureKind kind;
  /// Upper bound of keypoints an image. More finds weaker overlaps; time and memory of matching grow with it.
  int max_features = 1500;
  /// Larger images are shrunk to this longer side before anything is looked for, which bounds time and memory: SIFT over 20
  /// megapixels takes ten seconds and gigabytes. Keypoints are given in the image's own pixels all the same. More for finer
  /// detail, kLargestSidePx for images as they are.
  int max_side_px = 2400;
  /// Weakest response that is still detected, in the detector's own unit: see default_detection_threshold(), which holds for
  /// none. Higher is faster, and better where sensor noise yields features.
  std::optional<double> detection_threshold;
  /// Clip limit of the local contrast equalisation (CLAHE, Zuiderveld 1994) before detection. Higher brings out fainter texture
  /// and more noise. None leaves the image as it is: for evenly lit, well exposed images, or already equalised ones.
  std::optional<double> clahe_clip_limit = 1.5;
  /// Whether SIFT's descriptors are turned into RootSIFT (Arandjelovic and Zisserman, CVPR 2012): divided by their sum, then the
  /// square root, so that Euclidean distance compares them as histograms. False gives OpenCV's values in [0, 255], which a
  /// vocabulary trained elsewhere may expect.
  bool root_sift = true;
  Orientation orientation = Orientation::Dominant;
  /// For a steady number of features over rich and poor ground. None: one threshold for all images.
  std::optional<AdaptiveOptions> adaptive;
  SiftOptions sift;
  SurfOptions surf;
  StarOptions star;
  MserOptions mser;
  OrbOptions orb;
  BriskOptions brisk;
  KazeOptions akaze, kaze;
  CornerOptions fast, agast;
  GfttOptions gftt;
};

/// The detection threshold used when none is given: low, so that poor texture still yields features, and the even selection
/// drops the weak ones elsewhere. Its unit is the detector's:
/// - sift: contrast of the extremum, of 1, times the layers an octave (OpenCV's contrastThreshold);
/// - surf: determinant of the Hessian, squared grey levels (OpenCV's hessianThreshold; dlib's to within a third);
/// - star: difference of the means of centre and surround, grey levels;
/// - mser: difference of the means of region and surround, grey levels;
/// - orb, brisk, fast, agast: contrast of the circle with its centre, grey levels;
/// - akaze, kaze: determinant of the Hessian, of grey in [0, 1];
/// - gftt: eigenvalue as a share of the image's largest.
double default_detection_threshold(DetectorKind kind);

/// The threshold that holds: the given one, or the detector's default.
double detection_threshold(const FeatureOptions& options);

/// Throws InputError that names the option when one is out of range, or when the pairing makes no sense.
void validate(const FeatureOptions& options);

}  // namespace fabloop
