// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/recognition/recognition_folder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "frontend/recognition/curve_picture.h"
#include "frontend/recognition/judged_output.h"
#include "frontend/recognition/matrix_picture.h"
#include "frontend/recognition/plot.h"
#include "frontend/recognition/recognition_summary.h"
#include "frontend/sequence/trajectory.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

void write_hypotheses(const fs::path& path, const Recognition& recognition) {
  OutputFile file(path);
  file.stream() << "query,rank,place,match_frame,match_time_s,probability,log_likelihood,log_odds\n";
  for (const RecognizedImage& image : recognition.images) {
    for (std::size_t rank = 0; rank < image.matches.size(); ++rank) {
      const PlaceMatch& match = image.matches[rank];
      file.stream() << image.frame << ',' << rank + 1 << ',' << match.place << ',' << recognition.places[match.place].front()
                    << ',' << seconds_from_nanoseconds(recognition.place_times_ns[match.place]) << ',' << exact_text(match.probability)
                    << ',' << exact_text(match.log_likelihood) << ',' << exact_text(match.log_odds) << '\n';
    }
  }
  file.commit();
}

void write_places(const fs::path& path, const Recognition& recognition) {
  OutputFile file(path);
  file.stream() << "frame,time_s,place,is_new,p_new,num_words\n";
  for (const RecognizedImage& image : recognition.images) {
    file.stream() << image.frame << ',' << seconds_from_nanoseconds(image.time_ns) << ',' << image.place << ','
                  << (image.is_new ? 1 : 0) << ',' << exact_text(image.p_new) << ',' << image.num_words << '\n';
  }
  file.commit();
}

/// The places of the map, a line for each of their frames.
void write_map_places(const fs::path& path, const ObservedImages& map, const Recognition& recognition) {
  OutputFile file(path);
  file.stream() << "place,frame,time_s,num_words\n";
  for (PlaceId place = 0; place < recognition.places.size(); ++place) {
    for (const std::size_t frame : recognition.places[place]) {
      const auto image =
          std::lower_bound(map.images.begin(), map.images.end(), frame,
                           [](const ObservedImage& observed, std::size_t wanted) { return observed.frame < wanted; });
      file.stream() << place << ',' << frame << ',' << seconds_from_nanoseconds(image->time_ns) << ','
                    << image->observation.words.size() << '\n';
    }
  }
  file.commit();
}

/// What was recognised in what.
std::string title_of(const RecognitionReport& report) {
  return report.queries.name + (report.map ? " in " + report.map->name : "");
}

}  // namespace

RecognitionFolder::RecognitionFolder(const fs::path& path, OutputFolder::IfExists if_exists, NpyType matrix_type)
    : folder_(path, if_exists), matrix_type_(matrix_type) {
  p_place_.emplace(folder_.part_path() / "posterior.rows");
  log_likelihood_.emplace(folder_.part_path() / "log_likelihood.rows");
}

BeliefRow RecognitionFolder::on_row() {
  return [this](std::span<const double> p_place, std::span<const double> log_likelihood) {
    p_place_->add_row(p_place);
    log_likelihood_->add_row(log_likelihood);
  };
}

void RecognitionFolder::write_matrices(const RecognitionReport& report) {
  const fs::path& part = folder_.part_path();
  const std::size_t num_rows = report.recognition.images.size();
  const std::size_t num_columns = report.recognition.places.size();
  MatrixThumbnail p_cells(num_rows, num_columns), likelihood_cells(num_rows, num_columns);
  {
    NpyWriter posterior(part / "posterior.npy", matrix_type_, num_columns);
    p_place_->for_each_row([&](std::size_t index, std::span<const double> row) {
      posterior.add_row(row, 0.0);
      std::vector<double> logarithms;
      for (const double p : row) logarithms.push_back(std::log10(p));
      p_cells.add_row(index, logarithms);
    });
    posterior.commit();
    p_place_.reset();
  }
  NpyWriter likelihood(part / "log_likelihood.npy", matrix_type_, num_columns);
  log_likelihood_->for_each_row([&](std::size_t index, std::span<const double> row) {
    likelihood.add_row(row, std::numeric_limits<double>::quiet_NaN());
    likelihood_cells.add_row(index, above_median(row));
  });
  likelihood.commit();
  log_likelihood_.reset();

  std::optional<MatrixThumbnail> truth;
  if (report.truth) truth = truth_thumbnail(report.recognition, *report.truth);
  const MatrixThumbnail* const beside = truth ? &*truth : nullptr;
  write_png(part / "posterior.png", draw_matrix({title_of(report), p_cells, probability_scale(), beside}));
  write_png(part / "log_likelihood.png",
            draw_matrix({title_of(report), likelihood_cells, likelihood_scale(likelihood_cells), beside}));
}

void RecognitionFolder::finish(const RecognitionReport& report) {
  const fs::path& part = folder_.part_path();
  write_matrices(report);
  write_hypotheses(part / "hypotheses.csv", report.recognition);
  write_places(part / "places.csv", report.recognition);
  if (report.map) write_map_places(part / "map_places.csv", *report.map, report.recognition);
  if (report.judged) {
    write_precision_recall(part / "precision_recall.csv", *report.judged, "log_odds");
    write_png(part / "precision_recall.png", draw_precision_recall(title_of(report), *report.judged));
  }
  write_recognition_summary(part / "summary.json", report);
  folder_.commit();
}

}  // namespace fabloop
