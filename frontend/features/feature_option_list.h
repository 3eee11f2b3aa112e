// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frontend/features/feature_options.h"

namespace fabloop {

/// Calls visit(key, field, documentation) for every option: the one list from which settings files, model files and messages are
/// made. A key with a dot belongs to the section before it: a detector's name, or "adaptive", whose options are visited only
/// where they are set.
template <typename Options, typename Visit>
void for_each_option(Options& options, Visit&& visit) {
  visit("kind", options.kind, "DETECTOR or DETECTOR+DESCRIPTOR");
  visit("max_features", options.max_features, "at most so many keypoints an image");
  visit("max_side_px", options.max_side_px, "larger images are shrunk to this longer side first");
  visit("detection_threshold", options.detection_threshold, "weakest response, in the detector's unit; none: its default");
  visit("clahe_clip_limit", options.clahe_clip_limit, "local contrast equalisation before detection; none: the image as it is");
  visit("root_sift", options.root_sift, "SIFT descriptors as RootSIFT");
  visit("orientation", options.orientation, "dominant: along the gradient; upright: as the camera stands");
  if (options.adaptive) {
    visit("adaptive.min_features", options.adaptive->min_features, "lower the threshold below so many");
    visit("adaptive.max_features", options.adaptive->max_features, "raise it above so many");
    visit("adaptive.max_iterations", options.adaptive->max_iterations,
          "thresholds tried, where each takes a look of its own (orb, agast)");
    visit("adaptive.min_threshold_ratio", options.adaptive->min_threshold_ratio, "lowest threshold, as a share of the given one");
  }
  visit("sift.layers_per_octave", options.sift.layers_per_octave, "of the scale space");
  visit("sift.edge_threshold", options.sift.edge_threshold, "largest ratio of principal curvatures");
  visit("sift.sigma", options.sift.sigma, "blur of the first layer [px]");
  visit("surf.num_octaves", options.surf.num_octaves, "each doubles the size");
  visit("surf.layers_per_octave", options.surf.layers_per_octave, "scales of an octave in which maxima are looked for");
  visit("star.max_size_px", options.star.max_size_px, "diameter of the largest filter");
  visit("star.line_threshold", options.star.line_threshold, "largest tr^2 / det of the response's gradients");
  visit("star.line_threshold_scale", options.star.line_threshold_scale, "largest tr^2 / det of the best scale's gradients");
  visit("star.suppression_px", options.star.suppression_px, "window of non-maximum suppression, odd");
  visit("mser.delta", options.mser.delta, "grey levels over which a region is stable");
  visit("mser.min_area_px", options.mser.min_area_px, "smallest region");
  visit("mser.max_area_px", options.mser.max_area_px, "largest region");
  visit("mser.max_variation", options.mser.max_variation, "largest relative growth over delta");
  visit("mser.min_diversity", options.mser.min_diversity, "least relative difference between nested regions");
  visit("orb.scale_factor", options.orb.scale_factor, "between levels of the pyramid");
  visit("orb.num_levels", options.orb.num_levels, "of the pyramid");
  visit("orb.patch_size_px", options.orb.patch_size_px, "of the descriptor, and the image's edge without features");
  visit("brisk.num_octaves", options.brisk.num_octaves, "of the scale space; 0: one scale");
  visit("brisk.pattern_scale", options.brisk.pattern_scale, "of the sampling pattern");
  visit("akaze.num_octaves", options.akaze.num_octaves, "of the scale space");
  visit("akaze.layers_per_octave", options.akaze.layers_per_octave, "of the scale space");
  visit("kaze.num_octaves", options.kaze.num_octaves, "of the scale space");
  visit("kaze.layers_per_octave", options.kaze.layers_per_octave, "of the scale space");
  visit("fast.non_max_suppression", options.fast.non_max_suppression, "one corner a spot");
  visit("agast.non_max_suppression", options.agast.non_max_suppression, "one corner a spot");
  visit("gftt.min_distance_px", options.gftt.min_distance_px, "between corners");
  visit("gftt.block_size_px", options.gftt.block_size_px, "over which gradients are summed");
}

}  // namespace fabloop
