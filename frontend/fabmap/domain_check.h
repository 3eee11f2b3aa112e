// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "frontend/fabmap/domain.h"
#include "frontend/fabmap/held_out.h"
#include "frontend/fabmap/model.h"
#include "frontend/fabmap/observation.h"
#include "frontend/fabmap/tree_likelihood.h"
#include "frontend/progress.h"

namespace fabloop {

/// How familiar an image's words are: the probability that a word that it shows is seen in more images than a word that it
/// does not show (the area under the ROC curve of the words' frequencies; Mann & Whitney 1947). One half for images that
/// have nothing to do with those that the frequencies are of. Unlike a likelihood, it hardly depends on how many words an
/// image shows.
class Familiarity {
 public:
  /// `frequency`: of each word, larger for one that is seen more often. Only their order counts.
  explicit Familiarity(const std::vector<double>& frequency);

  /// One half where all words are seen, or none.
  double operator()(const Observation& observation) const;

 private:
  std::vector<double> rank_;  ///< Of each word, from 1; the mean of ranks where frequencies are equal.
};

/// How well the held-out images are explained by the others. None when fewer than 12 of them have words (about 60 training
/// images are needed): too few to tell what is usual.
std::optional<Domain> measure_domain(const HeldOut& held_out);

struct DomainCheckOptions {
  std::size_t window = 20;  ///< Images judged together. More is surer and later.
  double quantile = 0.01;   ///< An image is unlike the training set when it is less familiar than this share of that.
  double max_unlike = 0.5;  ///< Share of the window that may be unlike.
  Warn warn{};              ///< Told once, when more are.
};

/// Watches whether images look like those that a model was trained on: by their words' familiarity, and by their likelihood
/// under the tree. The first sees images of another sensor, the second words that do not go together. A word's probabilities mean
/// little elsewhere: p(new) and loops are then to be mistrusted, and the model to be trained on images of the place. Checks
/// nothing where the model does not know its training set's Domain (files of older versions, or of openFABMAP).
class DomainCheck {
 public:
  explicit DomainCheck(const Model& model, DomainCheckOptions options = {});

  /// The next image. Images without words do not count.
  void add(const Observation& observation);

  /// Whether a whole window has looked unlike the training set so far.
  bool is_unlike() const { return is_unlike_; }

 private:
  bool is_unlike_training(const Observation& observation) const;

  DomainCheckOptions options_;
  std::optional<Domain> domain_;
  Familiarity familiarity_;
  TreeLikelihood likelihood_;
  std::deque<bool> recent_;  ///< Which of the last images were unlike.
  bool is_unlike_ = false;
};

}  // namespace fabloop
