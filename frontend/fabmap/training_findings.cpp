// SPDX-License-Identifier: BSD-3-Clause
#include <sstream>

#include "frontend/fabmap/training_report.h"

namespace fabloop {
namespace {

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

template <typename... Parts>
std::string text(const Parts&... parts) {
  std::ostringstream stream;
  stream.precision(3);
  (stream << ... << parts);
  return stream.str();
}

std::string percent(std::size_t part, std::size_t whole) {
  return text(static_cast<int>(100.0 * share(part, whole) + 0.5), " %");
}

/// "3 of 20 (15 %)".
std::string part_of(std::size_t part, std::size_t whole) { return text(part, " of ", whole, " (", percent(part, whole), ")"); }

Grade grade_of(double value, double fair_above, double poor_above) {
  return value > poor_above ? Grade::Poor : value > fair_above ? Grade::Fair : Grade::Good;
}

Finding graded(double value, double fair_above, double poor_above, std::string figure, const std::string& advice) {
  const Grade grade = grade_of(value, fair_above, poor_above);
  return {grade, std::move(figure), grade == Grade::Good ? "good" : advice};
}

Finding images(const TrainingReport& report) {
  // A probability of 1 % is known to about a third of itself from 1,000 images, and hardly at all from 100.
  const Grade grade = report.num_images < 100 ? Grade::Poor : report.num_images < 300 ? Grade::Fair : Grade::Good;
  return {
      grade, text("images: ", report.num_images),
      grade == Grade::Good ? "good" : "few: which words go together is known roughly; train on some hundreds, of other places"};
}

Finding images_without_words(const TrainingReport& report) {
  return graded(share(report.num_images_without_words, report.num_images), 0.0, 0.1,
                text("images without words: ", part_of(report.num_images_without_words, report.num_images)),
                "they have no features and cannot be recognised; look at them, or lower the detection threshold");
}

Finding words_per_image(const TrainingReport& report) {
  const std::string figure = text("words an image: ", report.min_words_per_image, " at least, ", report.median_words_per_image,
                                  " at the median, ", report.max_words_per_image, " at most");
  const double seen = share(report.median_words_per_image, report.num_words);
  if (report.median_words_per_image < 30) {
    return {report.median_words_per_image < 10 ? Grade::Poor : Grade::Fair, figure,
            "few: one image tells little; find more features, or make more words"};
  }
  // Above a half, a word that is missing tells more than one that is seen.
  return graded(seen, 0.35, 0.6, figure,
                text("an image shows ", percent(report.median_words_per_image, report.num_words),
                     " of all words, so that a word tells little; make more words"));
}

Finding unseen_words(const TrainingReport& report) {
  const std::size_t useless = report.num_words_never_seen + report.num_words_always_seen;
  return graded(share(useless, report.num_words), 0.01, 0.1,
                text("words never seen: ", report.num_words_never_seen, ", always seen: ", report.num_words_always_seen, " of ",
                     report.num_words),
                "they tell nothing; make fewer words where never seen, more where always seen");
}

Finding words_in_one_image(const TrainingReport& report) {
  return graded(share(report.num_words_in_one_image, report.num_words), 0.1, 0.4,
                text("words in one image only: ", part_of(report.num_words_in_one_image, report.num_words)),
                "few images: what these words go together with is unknown; train on more images, or make fewer words");
}

Finding quantisation(const TrainingReport& report) {
  const std::string figure = text("distance of a descriptor to its word: ", report.distance_to_word,
                                  "; of a word to the nearest other: ", report.distance_between_words);
  if (report.distance_between_words <= 0.0) return {Grade::Poor, figure, "a single word tells nothing; make more words"};
  return graded(report.distance_to_word / report.distance_between_words, 1.5, 2.5, figure,
                "words lie closer together than descriptors do to them: small changes of view change the word; make fewer words");
}

Finding tree(const TrainingReport& report) {
  const double kept = report.entropy > 0.0 ? report.mutual_information / report.entropy : 0.0;
  return graded(-kept, -0.05, -0.01,
                text("mutual information in the tree: ", report.mutual_information, " of the words' ", report.entropy,
                     " nats an image (", static_cast<int>(100.0 * kept + 0.5), " %)"),
                "the words are nearly independent, so that the tree adds little; naive Bayes would do as well");
}

Finding held_out(const SelfTest& test) {
  if (test.num_held_out == 0) return {Grade::Poor, "held-out images: none", "too few images to hold some out; train on more"};
  const double gain = test.tree_log_likelihood - test.naive_bayes_log_likelihood;
  return graded(-gain, -1.0, 0.0,
                text("held-out images (", test.num_held_out, ") under the tree: ", test.tree_log_likelihood,
                     " nats, under naive Bayes: ", test.naive_bayes_log_likelihood),
                gain > 0.0 ? "the tree hardly helps on images that it was not trained on; train on more images"
                           : "the tree does harm on images that it was not trained on; train on more images");
}

Finding recall(const SelfTest& test) {
  if (test.num_recall_queries == 0) return {Grade::Poor, "self-recall: none tested", "no images with words"};
  return graded(
      1.0 - share(test.num_recalled, test.num_recall_queries), 0.01, 0.1,
      text("images found first from two thirds of their descriptors: ", part_of(test.num_recalled, test.num_recall_queries)),
      "images of the training set are taken for one another; make more words, or find more features");
}

Finding neighbours(const SelfTest& test) {
  return graded(1.0 - share(test.num_neighbours_first, test.num_neighbour_queries), 0.3, 0.7,
                text("images whose likeliest other image is at most 3 away: ",
                     part_of(test.num_neighbours_first, test.num_neighbour_queries)),
                "neighbours are seldom found first: natural for images without order, overlap or with many loops, else make more "
                "words");
}

}  // namespace

std::vector<Finding> findings(const TrainingReport& report) {
  return {images(report),
          images_without_words(report),
          words_per_image(report),
          unseen_words(report),
          words_in_one_image(report),
          quantisation(report),
          tree(report),
          held_out(report.self_test),
          recall(report.self_test),
          neighbours(report.self_test)};
}

}  // namespace fabloop
