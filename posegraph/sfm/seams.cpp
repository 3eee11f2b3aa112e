// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/seams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc/detail/gcgraph.hpp>
#include <optional>

namespace fabloop {
namespace {

constexpr double kSameColour = 25;  // grey values of difference that count as one unit
constexpr double kNotSeen = 3;      // units for a seam beside a block that one of the views does not show

class SeamProblem {
 public:
  SeamProblem(const MosaicBlocks& blocks, const Exposure& exposure, const std::vector<std::size_t>& camera_of,
              const SeamOptions& options)
      : blocks_(blocks), options_(options) {
    colours_.resize(blocks.entries.size());
    own_cost_.resize(blocks.entries.size());
    for (std::size_t block = 0; block < blocks.size(); ++block) prepare(block, exposure, camera_of);
    seams_.choice.resize(blocks.size());
    for (std::size_t block = 0; block < blocks.size(); ++block) {
      const float* costs = &own_cost_[block * MosaicBlocks::kMaxViews];
      const auto best = std::min_element(costs, costs + blocks.num_views[block]) - costs;
      seams_.choice[block] = blocks.num_views[block] > 0 ? static_cast<std::uint8_t>(best) : Seams::kNoView;
    }
    find_boxes();
  }

  Seams solve(std::size_t num_views) {
    for (int sweep = 0; sweep < options_.num_sweeps; ++sweep) {
      for (std::size_t view = 0; view < num_views; ++view) {
        if (view < boxes_.size() && boxes_[view].area() > 0) expand(static_cast<std::uint32_t>(view));
      }
    }
    return std::move(seams_);
  }

 private:
  void prepare(std::size_t block, const Exposure& exposure, const std::vector<std::size_t>& camera_of) {
    const auto seen = blocks_.at(block);
    const std::size_t first = block * MosaicBlocks::kMaxViews;
    if (seen.empty()) return;
    cv::Vec3f middle;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const cv::Vec3f gain = exposure.gain(seen[i].view, camera_of[seen[i].view], seen[i].radius);
      colours_[first + i] = cv::Vec3f(seen[i].colour).mul(gain);
    }
    for (int k = 0; k < 3; ++k) {
      std::array<float, MosaicBlocks::kMaxViews> values{};
      for (std::size_t i = 0; i < seen.size(); ++i) values[i] = colours_[first + i][k];
      std::nth_element(values.begin(), values.begin() + seen.size() / 2, values.begin() + seen.size());
      middle[k] = values[seen.size() / 2];
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const double lost = 1 - seen[i].quality / std::max(1e-6F, seen[0].quality);
      const double odd = seen.size() > 2 ? std::min(2.0, cv::norm(colours_[first + i] - middle) / kSameColour) : 0.0;
      own_cost_[first + i] = static_cast<float>(options_.quality_weight * lost + options_.outlier_weight * odd);
    }
  }

  void find_boxes() {
    for (std::size_t block = 0; block < blocks_.size(); ++block) {
      const int row = static_cast<int>(block / blocks_.grid.columns);
      const int column = static_cast<int>(block % blocks_.grid.columns);
      for (const BlockView& seen : blocks_.at(block)) {
        if (seen.view >= boxes_.size()) boxes_.resize(seen.view + 1);
        boxes_[seen.view] |= cv::Rect(column, row, 1, 1);
      }
    }
  }

  std::optional<std::uint8_t> entry_of(std::size_t block, std::uint32_t view) const {
    const auto seen = blocks_.at(block);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (seen[i].view == view) return static_cast<std::uint8_t>(i);
    }
    return std::nullopt;
  }

  /// What a seam shows at a block: how unlike the two views are there.
  double mismatch(std::size_t block, std::uint32_t view_a, std::uint32_t view_b) const {
    const auto a = entry_of(block, view_a);
    const auto b = entry_of(block, view_b);
    if (!a || !b) return kNotSeen;
    const std::size_t first = block * MosaicBlocks::kMaxViews;
    return std::min(kNotSeen, cv::norm(colours_[first + *a] - colours_[first + *b]) / kSameColour);
  }

  double pair_cost(std::size_t p, std::size_t q, std::uint32_t view_p, std::uint32_t view_q) const {
    if (view_p == view_q) return 0;
    return options_.length_weight + options_.colour_weight * (mismatch(p, view_p, view_q) + mismatch(q, view_p, view_q));
  }

  std::uint32_t current_view(std::size_t block) const { return blocks_.at(block)[seams_.choice[block]].view; }

  double own_cost(std::size_t block, std::uint8_t entry) const { return own_cost_[block * MosaicBlocks::kMaxViews + entry]; }

  /// Lets every block that `view` shows change to it, where that makes the whole cheaper.
  void expand(std::uint32_t view) {
    const cv::Rect box = boxes_[view];
    const auto node_at = [&](int row, int column) {
      return static_cast<std::size_t>(row - box.y) * box.width + (column - box.x);
    };
    std::vector<int> node(box.area(), -1);
    cv::detail::GCGraph<float> graph(static_cast<unsigned>(box.area()), static_cast<unsigned>(4 * box.area()));
    std::vector<std::array<double, 2>> terms;  // cost of keeping, cost of changing
    std::vector<std::size_t> block_of;
    std::vector<std::uint8_t> entry;
    for (int row = box.y; row < box.y + box.height; ++row) {
      for (int column = box.x; column < box.x + box.width; ++column) {
        const std::size_t block = static_cast<std::size_t>(row) * blocks_.grid.columns + column;
        const auto its = entry_of(block, view);
        if (!its || seams_.choice[block] == *its) continue;
        node[node_at(row, column)] = graph.addVtx();
        terms.push_back({own_cost(block, seams_.choice[block]), own_cost(block, *its)});
        block_of.push_back(block);
        entry.push_back(*its);
      }
    }
    const auto node_of = [&](std::size_t block) {
      const int row = static_cast<int>(block / blocks_.grid.columns);
      const int column = static_cast<int>(block % blocks_.grid.columns);
      return box.contains({column, row}) ? node[node_at(row, column)] : -1;
    };
    for (std::size_t i = 0; i < block_of.size(); ++i) add_pairs(graph, static_cast<int>(i), block_of[i], view, node_of, terms);
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const double least = std::min(terms[i][0], terms[i][1]);
      graph.addTermWeights(static_cast<int>(i), static_cast<float>(terms[i][1] - least), static_cast<float>(terms[i][0] - least));
    }
    if (block_of.empty()) return;
    graph.maxFlow();
    for (std::size_t i = 0; i < block_of.size(); ++i) {
      if (!graph.inSourceSegment(static_cast<int>(i))) seams_.choice[block_of[i]] = entry[i];
    }
  }

  template <typename NodeOf>
  void add_pairs(cv::detail::GCGraph<float>& graph, int i, std::size_t p, std::uint32_t view, const NodeOf& node_of,
                 std::vector<std::array<double, 2>>& terms) const {
    const std::size_t columns = blocks_.grid.columns;
    const std::size_t column = p % columns;
    const std::array<std::pair<bool, std::size_t>, 4> neighbours{{{column + 1 < columns, p + 1},
                                                                  {p + columns < blocks_.size(), p + columns},
                                                                  {column > 0, p - 1},
                                                                  {p >= columns, p - columns}}};
    for (std::size_t k = 0; k < neighbours.size(); ++k) {
      const auto [exists, q] = neighbours[k];
      if (!exists || seams_.choice[q] == Seams::kNoView) continue;
      const int j = node_of(q);
      if (j < 0) {  // q stays as it is
        terms[i][0] += pair_cost(p, q, current_view(p), current_view(q));
        terms[i][1] += pair_cost(p, q, view, current_view(q));
      } else if (k < 2) {  // each pair once; Kolmogorov & Zabih 2004, section 4
        const double keep_both = pair_cost(p, q, current_view(p), current_view(q));
        const double change_q = pair_cost(p, q, current_view(p), view);
        const double change_p = pair_cost(p, q, view, current_view(q));
        terms[i][1] += change_p - keep_both;
        terms[j][1] -= change_p;
        // Blocks that a view does not show break the triangle inequality; such an edge then counts nothing.
        graph.addEdges(i, j, static_cast<float>(std::max(0.0, change_q + change_p - keep_both)), 0.0F);
      }
    }
  }

  const MosaicBlocks& blocks_;
  const SeamOptions& options_;
  std::vector<cv::Vec3f> colours_;
  std::vector<float> own_cost_;
  std::vector<cv::Rect> boxes_;
  Seams seams_;
};

}  // namespace

Seams find_seams(const MosaicBlocks& blocks, const Exposure& exposure, const std::vector<std::size_t>& camera_of,
                 const SeamOptions& options) {
  return SeamProblem(blocks, exposure, camera_of, options).solve(camera_of.size());
}

}  // namespace fabloop
