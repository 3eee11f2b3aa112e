// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fabloop {

/// What finds keypoints.
enum class DetectorKind {
  Sift,   ///< Extrema of differences of Gaussians (Lowe 2004).
  Surf,   ///< Maxima of the box-filtered Hessian's determinant (Bay et al. 2008).
  Star,   ///< Centre-surround extrema at full resolution (CenSurE, Agrawal et al. 2008).
  Mser,   ///< Maximally stable extremal regions (Matas et al. 2002).
  Orb,    ///< FAST corners in a pyramid (Rublee et al. 2011).
  Brisk,  ///< AGAST corners in a scale space (Leutenegger et al. 2011).
  Akaze,  ///< Hessian maxima in a fast non-linear scale space (Alcantarilla et al. 2013).
  Kaze,   ///< The same in one computed exactly (Alcantarilla et al. 2012).
  Fast,   ///< Corners by a segment test, at one scale (Rosten and Drummond 2006).
  Agast,  ///< The same with an adaptive decision tree (Mair et al. 2010).
  Gftt,   ///< Corners by the lesser eigenvalue of the gradients, at one scale (Shi and Tomasi 1994).
};

/// What describes them. Descriptors of one kind compare with each other, whatever detected them.
enum class DescriptorKind {
  Sift,   ///< 128 floats.
  Surf,   ///< 64 floats.
  Orb,    ///< 32 bytes of bits.
  Brisk,  ///< 64 bytes of bits.
  Akaze,  ///< 61 bytes of bits; of its own keypoints only.
  Kaze,   ///< 64 floats; of its own keypoints only.
};

/// A detector with a descriptor.
struct FeatureKind {
  DetectorKind detector = DetectorKind::Sift;
  DescriptorKind descriptor = DescriptorKind::Sift;

  bool operator==(const FeatureKind&) const = default;
};

/// What one descriptor is made of.
struct DescriptorLayout {
  int size = 0;      ///< Columns: floats, or bytes of packed bits.
  int cv_type = -1;  ///< CV_32F (compare by Euclidean distance) or CV_8U (compare by Hamming distance).
};

DescriptorLayout descriptor_layout(DescriptorKind kind);

/// The names used in options and files: "sift", "fast", ...
std::string_view to_string(DetectorKind kind);
std::string_view to_string(DescriptorKind kind);

/// "sift" for SIFT with its own descriptor, else "star+surf".
std::string to_string(const FeatureKind& kind);

/// Reads "DETECTOR" or "DETECTOR+DESCRIPTOR". A detector alone has its own descriptor or, where it has none, a good one:
/// star+surf, mser+sift, fast+brisk, agast+orb, gftt+sift. None for any other text; a pairing may still make no sense.
std::optional<FeatureKind> feature_kind_from_string(std::string_view name);

/// Throws InputError that names what would work when the descriptor cannot describe what the detector finds: AKAZE and KAZE
/// describe in the scale space of their own detector only.
void require_sensible(const FeatureKind& kind);

/// Every detector with its default descriptor, in the order of DetectorKind.
std::vector<FeatureKind> default_feature_kinds();

/// "sift, surf, star, ...": the detectors' or the descriptors' names, for help and messages.
std::string detector_names();
std::string descriptor_names();

}  // namespace fabloop
