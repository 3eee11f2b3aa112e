// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>

#include "frontend/fabmap/vocabulary.h"
#include "frontend/progress.h"

namespace fabloop {

/// Where k-means stands between two iterations: all that the next one depends on, besides descriptors and options.
struct KMeansState {
  int num_iterations = 0;                 ///< Done so far.
  cv::Mat centres;                        ///< num_words x D, CV_32F.
  std::vector<std::uint32_t> assignment;  ///< N: the centre of each descriptor in the last iteration.
  double inertia = 0.0;                   ///< Sum of squared distances in the last iteration.
};

struct KMeansOptions {
  std::size_t num_words = 1000;  ///< More tell places apart better and want more training images.
  int max_iterations = 25;
  /// Stops when the mean squared distance falls by less than this part of it. Smaller for slightly better words.
  double min_improvement = 1e-3;
  std::uint64_t seed = 1;
  int num_threads = 0;  ///< 0: all. The words do not depend on it.
  Progress progress;
  std::optional<KMeansState> start;                         ///< Of a former run on the same descriptors: goes on from there.
  std::function<void(const KMeansState&)> after_iteration;  ///< Called after each iteration that another one follows.
};

/// Words by k-means (Lloyd 1982) from a random choice of `descriptors` (N x D, as float_descriptors makes them). A word that
/// loses all its descriptors starts again at the descriptor worst represented. Where there are many, each is compared with the
/// word that it had and those of nearby cells (see RowSearch::near) until the end, and then with all. Every word is the mean of
/// at least one descriptor, so there are fewer than wanted where there are fewer different descriptors. Words of packed bits are
/// means of bits. Throws InputError for no descriptors or no words wanted.
Vocabulary train_k_means(const cv::Mat& descriptors, const KMeansOptions& options = {});

struct RadiusClusteringOptions {
  /// Euclidean distance, in units of the descriptor (the square root of the Hamming distance for packed bits). Smaller gives
  /// more words. Must be set.
  double radius = 0.0;
  std::size_t max_words = 20000;  ///< More is an error, since the radius is then most likely wrong.
  std::uint64_t seed = 1;         ///< Of the order in which descriptors are looked at.
  int num_threads = 0;            ///< 0: all. The words do not depend on it.
  Progress progress;
};

/// The descriptors, among `descriptors` (N x D) in an order by chance, that are further than the radius from all chosen before.
/// So all are further than the radius apart, and every descriptor has one within the radius (to the rounding of floats).
/// The order comes from the seed and the descriptors' own numbers, so that theirs does not matter.
/// Throws InputError for no descriptors, a radius that is not positive, and more words than allowed.
cv::Mat radius_centres(const cv::Mat& descriptors, const RadiusClusteringOptions& options);

/// Words by modified sequential clustering (Teynor & Burkhardt 2007; OpenFABMAP's): each is the mean of the descriptors
/// nearest to one of radius_centres. Rare descriptors get words of their own, common ones no more than their share. Throws as
/// radius_centres does.
Vocabulary train_radius_clustering(const cv::Mat& descriptors, const RadiusClusteringOptions& options);

}  // namespace fabloop
