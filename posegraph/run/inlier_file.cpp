// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/run/inlier_file.h"

#include <array>

#include "frontend/error.h"
#include "frontend/npy.h"

namespace fabloop {
namespace {

constexpr std::size_t kColumns = 6;

}  // namespace

void write_inliers(const std::filesystem::path& path, const Map& map) {
  std::map<std::size_t, const View*> view_of_frame;
  for (const View& view : map.views) view_of_frame[view.frame] = &view;
  NpyWriter writer(path, NpyType::Float32, kColumns);
  for (const LoopEvent& event : map.events) {
    for (const HypothesisOutcome& outcome : event.hypotheses) {
      if (outcome.match_session != event.session) continue;
      for (const Match& inlier : outcome.verification.inliers) {
        const auto pixel = [&](std::size_t frame, int index) {
          return view_of_frame.at(frame)->features.keypoints.at(static_cast<std::size_t>(index)).pt;
        };
        const cv::Point2f query = pixel(event.query, inlier.query), match = pixel(outcome.match, inlier.match);
        writer.add_row(std::array<double, kColumns>{static_cast<double>(event.query), static_cast<double>(outcome.match), query.x,
                                                    query.y, match.x, match.y});
      }
    }
  }
  writer.commit();
}

void write_inliers(const std::filesystem::path& path, const InlierPixels& inliers) {
  NpyWriter writer(path, NpyType::Float32, kColumns);
  for (const auto& [frames, pairs] : inliers) {
    for (const PixelPair& pair : pairs) {
      writer.add_row(std::array<double, kColumns>{static_cast<double>(frames.first), static_cast<double>(frames.second),
                                                  pair.query.x, pair.query.y, pair.match.x, pair.match.y});
    }
  }
  writer.commit();
}

InlierPixels read_inliers(const std::filesystem::path& path) {
  NpyReader reader(path);
  if (reader.num_columns() != kColumns) {
    throw InputError(path.string() + ": has " + std::to_string(reader.num_columns()) +
                     " columns, not query, match, x_query, y_query, x_match, y_match; give the folder that a run wrote");
  }
  InlierPixels inliers;
  std::array<double, kColumns> row{};
  for (std::size_t i = 0; i < reader.num_rows(); ++i) {
    reader.read_row(row);
    if (!(row[0] >= 0.0 && row[1] >= 0.0)) throw InputError(path.string() + ": row " + std::to_string(i) + " names no frames");
    inliers[{static_cast<std::size_t>(row[0]), static_cast<std::size_t>(row[1])}].push_back(
        {cv::Point2f(static_cast<float>(row[2]), static_cast<float>(row[3])),
         cv::Point2f(static_cast<float>(row[4]), static_cast<float>(row[5]))});
  }
  return inliers;
}

}  // namespace fabloop
