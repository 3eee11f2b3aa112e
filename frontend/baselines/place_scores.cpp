// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/baselines/place_scores.h"

#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "frontend/baselines/tf_idf.h"
#include "frontend/error.h"
#include "frontend/parallel.h"
#include "frontend/recognition/recognition_run.h"

namespace fabloop {
namespace {

/// Who is looked up among whom; `map` is null within one sequence.
struct Problem {
  const Model* model;
  const std::vector<ImageDigest>* map;
  const std::vector<ImageDigest>& queries;
  const PlaceScoreOptions& options;

  const std::vector<ImageDigest>& places() const { return map ? *map : queries; }
};

std::vector<std::size_t> frames_of(const std::vector<ImageDigest>& images) {
  std::vector<std::size_t> frames;
  for (const ImageDigest& image : images) frames.push_back(image.frame);
  return frames;
}

/// Fills every row with what `score(query, place)` says, in parallel.
void fill(ScoreTable& table, int num_threads, const std::function<double(std::size_t query, std::size_t place)>& score) {
  parallel_for(table.rows.size(), num_threads, [&](std::size_t query) {
    std::vector<double>& scores = table.rows[query].scores;
    for (std::size_t place = 0; place < scores.size(); ++place) scores[place] = score(query, place);
  });
}

void fill_tf_idf(const Problem& problem, ScoreTable& table) {
  const std::vector<double> idf = inverse_document_frequencies(problem.model->tree);
  const auto bags_of = [&](const std::vector<ImageDigest>& images) {
    std::vector<BagOfWords> bags;
    for (const ImageDigest& image : images) bags.push_back(tf_idf_bag(image.words, idf));
    return bags;
  };
  const std::vector<BagOfWords> queries = bags_of(problem.queries);
  const std::vector<BagOfWords> of_map = problem.map ? bags_of(*problem.map) : std::vector<BagOfWords>{};
  const std::vector<BagOfWords>& places = problem.map ? of_map : queries;
  fill(table, problem.options.num_threads, [&](std::size_t q, std::size_t p) { return l1_score(queries[q], places[p]); });
}

void fill_vlad(const Problem& problem, ScoreTable& table) {
  const auto& places = problem.places();
  fill(table, problem.options.num_threads,
       [&](std::size_t q, std::size_t p) { return vlad_score(problem.queries[q].vlad, places[p].vlad); });
}

/// Differences to all places that there were, recent ones too: lines of a slow route run through them.
void fill_sequences(const Problem& problem, ScoreTable& table) {
  const auto& places = problem.places();
  DifferenceRows differences(table.rows.size());
  parallel_for(table.rows.size(), problem.options.num_threads, [&](std::size_t q) {
    const cv::Mat1f& query = problem.queries[q].small;
    for (std::size_t p = 0; p < table.rows[q].num_places; ++p) {
      differences[q].push_back(
          static_cast<float>(cv::norm(query, places[p].small, cv::NORM_L1) / static_cast<double>(query.total())));
    }
  });
  std::vector<std::vector<double>> scores = sequence_scores(differences, problem.options.sequence);
  for (std::size_t q = 0; q < table.rows.size(); ++q) {
    scores[q].resize(table.rows[q].scores.size());
    table.rows[q].scores = std::move(scores[q]);
  }
}

std::vector<ObservedImage> observed(const std::vector<ImageDigest>& images) {
  std::vector<ObservedImage> result;
  for (const ImageDigest& image : images) {
    ObservedImage seen;
    seen.frame = image.frame;
    seen.time_ns = image.time_ns;
    seen.observation = observation_of(image.words);
    result.push_back(std::move(seen));
  }
  return result;
}

void fill_fabmap(const Problem& problem, const Model& model, ScoreTable& table) {
  RecognitionOptions options;
  options.slam = problem.options.slam;
  options.slam.revisit = Revisit::Never;
  options.max_matches = table.place_frames.size();
  options.num_recent_excluded = problem.map ? 0 : problem.options.num_recent_excluded;
  const Recognition recognition = problem.map
                                      ? recognize_in_map(model, observed(*problem.map), observed(problem.queries), options)
                                      : recognize_sequence(model, observed(problem.queries), options);
  for (std::size_t q = 0; q < table.rows.size(); ++q) {
    for (const PlaceMatch& match : recognition.images[q].matches) table.rows[q].scores[match.place] = match.log_odds;
  }
}

ScoreTable score(PlaceMethod method, const Problem& problem) {
  if (needs_model(method) && !problem.model) {
    throw InputError("the method " + std::string(to_string(method)) + " needs a model; train one first");
  }
  ScoreTable table = empty_scores(frames_of(problem.queries), frames_of(problem.places()), problem.map == nullptr,
                                  problem.map ? 0 : problem.options.num_recent_excluded);
  table.label = label_of(method);
  switch (method) {
    case PlaceMethod::FabMap:
      fill_fabmap(problem, *problem.model, table);
      break;
    case PlaceMethod::NaiveBayes:
      fill_fabmap(problem, naive_bayes(*problem.model), table);
      break;
    case PlaceMethod::TfIdf:
      fill_tf_idf(problem, table);
      break;
    case PlaceMethod::Vlad:
      fill_vlad(problem, table);
      break;
    case PlaceMethod::SeqSlam:
      fill_sequences(problem, table);
      break;
  }
  return table;
}

}  // namespace

ScoreTable score_sequence(PlaceMethod method, const Model* model, const std::vector<ImageDigest>& images,
                          const PlaceScoreOptions& options) {
  return score(method, {model, nullptr, images, options});
}

ScoreTable score_in_map(PlaceMethod method, const Model* model, const std::vector<ImageDigest>& map,
                        const std::vector<ImageDigest>& queries, const PlaceScoreOptions& options) {
  return score(method, {model, &map, queries, options});
}

}  // namespace fabloop
