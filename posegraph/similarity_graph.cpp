// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/similarity_graph.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "frontend/error.h"
#include "posegraph/connectivity.h"
#include "posegraph/information.h"
#include "posegraph/initialization.h"
#include "posegraph/rigid_part.h"

namespace fabloop {
namespace {

bool is_usable(const Similarity& similarity) {
  return std::isfinite(similarity.scale) && similarity.scale > 0.0 && similarity.rotation.coeffs().allFinite() &&
         similarity.translation.allFinite();
}

/// Part of the largest weight that an edge has at least, so that a vertex joined by edges without information has a scale.
constexpr double kMinRelativeScaleWeight = 1e-9;

std::vector<double> weights_of_scale(const SimilarityGraph& graph) {
  std::vector<double> weights;
  for (const SimilarityEdge& edge : graph.edges) weights.push_back(std::max(0.0, edge.information(6, 6)));
  const double largest = weights.empty() ? 0.0 : *std::max_element(weights.begin(), weights.end());
  for (double& weight : weights) weight = largest > 0.0 ? std::max(weight, kMinRelativeScaleWeight * largest) : 1.0;
  return weights;
}

/// Logarithms of scales: min sum of w (log s_j - log s_i - log s_ij)^2, the anchors held.
std::vector<double> solve_log_scales(const SimilarityGraph& graph, const std::vector<std::size_t>& anchors) {
  constexpr int kHeld = -1;
  std::vector<double> log_scales;
  for (const SimilarityVertex& vertex : graph.vertices) log_scales.push_back(std::log(vertex.world_from_frame.scale));
  std::vector<int> row(graph.vertices.size(), 0);
  for (const std::size_t anchor : anchors) row[anchor] = kHeld;
  int size = 0;
  for (int& r : row) r = r == kHeld ? kHeld : size++;
  if (size == 0) return log_scales;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
  std::vector<Eigen::Triplet<double>> entries;
  const std::vector<double> weights = weights_of_scale(graph);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const SimilarityEdge& edge = graph.edges[e];
    const double step = std::log(edge.from_from_to.scale);
    const auto add = [&](std::size_t end, std::size_t other, double end_from_other) {
      if (row[end] == kHeld) return;
      entries.emplace_back(row[end], row[end], weights[e]);
      if (row[other] != kHeld) entries.emplace_back(row[end], row[other], -weights[e]);
      right(row[end]) += weights[e] * (end_from_other + (row[other] == kHeld ? log_scales[other] : 0.0));
    };
    add(edge.to, edge.from, step);
    add(edge.from, edge.to, -step);
  }
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  // Every free vertex hangs by edges of positive weight on an anchor, so the matrix is positive definite.
  const Eigen::VectorXd solution = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
  for (std::size_t v = 0; v < row.size(); ++v) {
    if (row[v] != kHeld) log_scales[v] = solution(row[v]);
  }
  return log_scales;
}

}  // namespace

void check(const SimilarityGraph& graph) {
  for (const SimilarityVertex& vertex : graph.vertices) {
    if (is_usable(vertex.world_from_frame)) continue;
    throw InputError("similarity graph: vertex " + std::to_string(vertex.id) +
                     " has numbers that are not finite, or a scale that is not positive");
  }
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const SimilarityEdge& edge = graph.edges[e];
    const auto fail = [&](const std::string& what) {
      throw InputError("similarity graph: edge " + std::to_string(e) + " (counted from 0) " + what);
    };
    if (edge.from >= graph.vertices.size() || edge.to >= graph.vertices.size()) fail("refers to a vertex that is not there");
    if (edge.from == edge.to) fail("joins a vertex to itself");
    if (!is_usable(edge.from_from_to)) fail("has numbers that are not finite, or a scale that is not positive");
    if (!edge.information.allFinite()) fail("has an information matrix that is not finite");
  }
}

SimilarityGraph similarity_graph_from(const PoseGraph& graph, double sigma_of_scale) {
  check(graph);
  if (!(sigma_of_scale > 0.0)) throw InputError("similarity graph: the relative error of a scale must be positive");
  if (graph.dimension != 3) throw InputError("similarity graph: is of space, the pose graph is planar");
  if (!graph.priors.empty()) throw InputError("similarity graph: has no priors; take them out of the pose graph");
  SimilarityGraph result;
  for (const Vertex& vertex : graph.vertices) {
    result.vertices.push_back({vertex.id, similarity_from(vertex.world_from_frame), vertex.fixed});
  }
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const Edge& edge = graph.edges[e];
    if (!edge.has_scale) {
      throw InputError("similarity graph: edge " + std::to_string(e) +
                       " (counted from 0) knows no distance; place its vertices by structure first");
    }
    SimilarityEdge similar{edge.from, edge.to, similarity_from(edge.from_from_to), Matrix7d::Zero(), edge.kind};
    similar.information.topLeftCorner<6, 6>() = edge.information;
    similar.information(6, 6) = 1.0 / (sigma_of_scale * sigma_of_scale);
    result.edges.push_back(similar);
  }
  return result;
}

void initialize_chordal(SimilarityGraph& graph) {
  check(graph);
  PoseGraph rigid = rigid_part(graph);
  const std::vector<std::size_t> anchors = find_anchors(rigid, connected_components(rigid));
  const std::vector<double> log_scales = solve_log_scales(graph, anchors);
  for (std::size_t v = 0; v < graph.vertices.size(); ++v) {
    if (!std::binary_search(anchors.begin(), anchors.end(), v))
      graph.vertices[v].world_from_frame.scale = std::exp(log_scales[v]);
  }
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    rigid.edges[e].from_from_to.translation *= graph.vertices[graph.edges[e].from].world_from_frame.scale;
    const double world_by_j = graph.vertices[graph.edges[e].to].world_from_frame.scale;
    rigid.edges[e].information.topLeftCorner<3, 3>() /= world_by_j * world_by_j;
  }
  initialize_chordal(rigid);
  set_rigid_part(rigid, graph);
}

void chain_along_edges(SimilarityGraph& graph) {
  for (const EdgeStep& step : breadth_first(rigid_part(graph))) {
    const SimilarityEdge& edge = graph.edges[step.edge];
    const Similarity from_from_to = edge.from == step.from ? edge.from_from_to : edge.from_from_to.inverse();
    graph.vertices[step.to].world_from_frame = graph.vertices[step.from].world_from_frame * from_from_to;
  }
}

}  // namespace fabloop
