// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <optional>
#include <vector>

#include "apps/recognize_arguments.h"
#include "frontend/baselines/place_scores.h"
#include "frontend/baselines/score_folder.h"
#include "frontend/fabmap/model.h"

namespace fabloop::apps {
namespace {

ImageDigests digest_source(const std::string& path, const ImageDigester& digester, const RecognizeArguments& arguments,
                           const CommonOptions& common) {
  ImageSource source(path, arguments.source);
  DigestOptions options;
  options.num_threads = common.num_threads;
  options.progress = arguments.options.progress;
  return digest_images(source, digester, options);
}

/// What a truth asks of images: when they were taken.
std::vector<ObservedImage> times_of(const ImageDigests& digests) {
  std::vector<ObservedImage> images;
  for (const ImageDigest& digest : digests.images) {
    ObservedImage image;
    image.frame = digest.frame;
    image.time_ns = digest.time_ns;
    images.push_back(image);
  }
  return images;
}

std::vector<std::size_t> frames_of(const ImageDigests& digests) {
  std::vector<std::size_t> frames;
  for (const ImageDigest& digest : digests.images) frames.push_back(digest.frame);
  return frames;
}

ScoreTable scores_of(const RecognizeArguments& arguments, const CommonOptions& common, const Model* model,
                     const ImageDigests& queries, const ImageDigests* map) {
  const auto method = place_method_named(arguments.method);
  if (!method) {
    ScoreTable table =
        empty_scores(frames_of(queries), frames_of(map ? *map : queries), map == nullptr, arguments.options.num_recent_excluded);
    read_scores(arguments.method, table);
    return table;
  }
  PlaceScoreOptions options;
  options.num_recent_excluded = arguments.options.num_recent_excluded;
  options.num_threads = common.num_threads;
  return map ? score_in_map(*method, model, map->images, queries.images, options)
             : score_sequence(*method, model, queries.images, options);
}

}  // namespace

void run_recognize_scores(const RecognizeArguments& arguments, const CommonOptions& common) {
  OutputFolder folder(arguments.out, arguments.overwrite ? OutputFolder::IfExists::Replace : OutputFolder::IfExists::Refuse);
  const auto method = place_method_named(arguments.method);
  std::optional<Model> model;
  if (method && needs_model(*method)) model = read_model(arguments.model);
  const ImageDigester digester(method ? std::vector<PlaceMethod>{*method} : std::vector<PlaceMethod>{},
                               model ? &*model : nullptr);
  std::optional<ImageDigests> map;
  if (!arguments.map.empty()) map = digest_source(arguments.map, digester, arguments, common);
  const ImageDigests queries = digest_source(arguments.sequence, digester, arguments, common);
  std::optional<GroundTruth> truth;
  if (!arguments.truth.empty()) {
    truth =
        map ? read_truth_in_map(arguments.truth, times_of(queries), arguments.map_truth, times_of(*map), arguments.truth_options)
            : read_truth(arguments.truth, times_of(queries), arguments.truth_options);
  }
  const ScoreTable table = scores_of(arguments, common, model ? &*model : nullptr, queries, map ? &*map : nullptr);
  std::optional<PrecisionRecall> judged;
  if (truth) judged = judge_scores(table, *truth, arguments.options.max_matches, arguments.judging);
  write_scores(folder, {arguments.method, table, queries.name, map ? map->name : "", queries.damaged_frames.size(),
                        arguments.options.num_recent_excluded, arguments.options.max_matches, judged ? &*judged : nullptr});
  std::cout << "method:  " << table.label << "\nimages:  " << table.rows.size() << " looked up";
  if (!queries.damaged_frames.empty()) std::cout << ", " << queries.damaged_frames.size() << " damaged";
  std::cout << "\nplaces:  " << table.place_frames.size() << '\n';
  if (judged) print_judged(*judged);
  std::cout << "look at: " << arguments.out << (judged ? "/precision_recall.png, " : "/hypotheses.csv, ") << arguments.out
            << "/summary.json\n";
}

}  // namespace fabloop::apps
