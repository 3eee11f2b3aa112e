// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "frontend/error.h"
#include "posegraph/connectivity.h"
#include "posegraph/g2o/g2o_io.h"
#include "posegraph/g2o/g2o_line.h"
#include "posegraph/g2o/g2o_line_reader.h"
#include "posegraph/information.h"
#include "posegraph/initialization.h"

namespace fabloop {
namespace {

using namespace g2o;

constexpr const char* kKnownTags =
    "VERTEX_SE3:QUAT, EDGE_SE3:QUAT, EDGE_SE3_DIRECTION:QUAT, EDGE_SE3_PRIOR, EDGE_SE3_POSITION_PRIOR, EDGE_SE3_ATTITUDE_PRIOR, "
    "VERTEX_SE2, EDGE_SE2, EDGE_PRIOR_SE2, EDGE_PRIOR_SE2_XY, FIX, and TORO's VERTEX2, EDGE2, VERTEX3 and EDGE3";

/// An edge whose ends are still ids.
struct PendingEdge {
  std::int64_t from_id = 0;
  std::int64_t to_id = 0;
  Edge edge;
  int line = 0;
};

/// A prior whose vertex is still an id.
struct PendingPrior {
  std::int64_t id = 0;
  VertexPrior prior;
  int line = 0;
};

class Reader {
 public:
  Reader(const std::filesystem::path& path, const G2oOptions& options) : path_(path), lines_(path, options) {}

  PoseGraph read() {
    lines_.read([this](const Words& words) { read_line(words); });
    if (graph_.vertices.empty() && edges_.empty()) {
      throw InputError(path_.string() + ": has no vertices and no edges; a .g2o file has lines of " + kKnownTags);
    }
    finish();
    return std::move(graph_);
  }

 private:
  void read_line(const Words& words) {
    const std::string_view tag = words.front();
    if (tag == "VERTEX_SE3:QUAT") return read_vertex(words, Layout::Quaternion);
    if (tag == "VERTEX_SE2") return read_vertex(words, Layout::Planar);
    if (tag == "VERTEX3") return read_vertex(words, Layout::EulerToro);
    if (tag == "VERTEX2") return read_vertex(words, Layout::PlanarToro);
    if (tag == "EDGE_SE3:QUAT") return read_edge(words, Layout::Quaternion, true);
    if (tag == "EDGE_SE3_DIRECTION:QUAT") return read_edge(words, Layout::Quaternion, false);
    if (tag == "EDGE_SE2") return read_edge(words, Layout::Planar, true);
    if (tag == "EDGE3") return read_edge(words, Layout::EulerToro, true);
    if (tag == "EDGE2") return read_edge(words, Layout::PlanarToro, true);
    if (tag == "EDGE_SE3_PRIOR") return read_spatial_prior(words);
    if (tag == "EDGE_PRIOR_SE2") return read_prior(words, Layout::Planar, 2);
    if (tag == "EDGE_PRIOR_SE2_XY") return read_position(words, 2);
    if (tag == "EDGE_SE3_POSITION_PRIOR") return read_position(words, 3);
    if (tag == "EDGE_SE3_ATTITUDE_PRIOR") return read_attitude(words);
    if (tag == "PARAMS_SE3OFFSET") return read_offset(words);
    if (tag.starts_with("VERTEX_SIM3") || tag.starts_with("EDGE_SIM3")) {
      lines_.fail(quoted(tag) + " is of a graph of similarities, which this is not for; 'fabloop optimize' takes such files");
    }
    lines_.fail_at_unknown_tag(tag, kKnownTags);
  }

  void read_vertex(const Words& words, Layout layout) {
    set_dimension(dimension_of(layout));
    lines_.expect_columns(words, 2 + pose_size(layout), std::string("id ") + pose_columns(layout));
    Vertex vertex;
    vertex.id = lines_.id(words[1]);
    vertex.world_from_frame = pose(words, 2, layout);
    lines_.add_vertex(vertex.id);
    graph_.vertices.push_back(vertex);
  }

  void read_edge(const Words& words, Layout layout, bool has_scale) {
    set_dimension(dimension_of(layout));
    const std::size_t information_start = 3 + pose_size(layout);
    lines_.expect_columns(words, information_start + information_size(layout),
                          std::string("i j ") + pose_columns(layout) + " and " + std::to_string(information_size(layout)) +
                              " information entries of the upper triangle");
    PendingEdge pending{lines_.id(words[1]), lines_.id(words[2]), {}, lines_.line()};
    if (pending.from_id == pending.to_id) lines_.fail("the edge joins vertex " + text_of(words[1]) + " to itself; remove it");
    Edge& edge = pending.edge;
    edge.has_scale = has_scale;
    edge.from_from_to = pose(words, 3, layout);
    if (!has_scale && edge.from_from_to.translation.norm() == 0.0)
      lines_.fail("the direction has length zero; give a unit vector");
    edge.information = information(words, information_start, layout);
    edge.kind = lines_.take_kind(pending.from_id, pending.to_id);
    edges_.push_back(pending);
  }

  /// `start`: the column of the pose.
  void read_prior(const Words& words, Layout layout, std::size_t start) {
    set_dimension(dimension_of(layout));
    lines_.expect_columns(words, start + pose_size(layout) + information_size(layout),
                          std::string("id ") + pose_columns(layout) + " and " + std::to_string(information_size(layout)) +
                              " information entries of the upper triangle");
    VertexPrior prior;
    prior.world_from_frame = pose(words, start, layout);
    prior.information = information(words, start + pose_size(layout), layout);
    priors_.push_back({lines_.id(words[1]), prior, lines_.line()});
  }

  /// g2o writes the id of a PARAMS_SE3OFFSET after the vertex, others do not.
  void read_spatial_prior(const Words& words) {
    constexpr std::size_t kColumnsWithOffset = 3 + 7 + 21;
    if (words.size() != kColumnsWithOffset) return read_prior(words, Layout::Quaternion, 2);
    if (!offsets_.contains(lines_.id(words[2])))
      lines_.fail("there is no PARAMS_SE3OFFSET " + text_of(words[2]) + " before this line");
    read_prior(words, Layout::Quaternion, 3);
  }

  void read_offset(const Words& words) {
    lines_.expect_columns(words, 2 + pose_size(Layout::Quaternion), "id x y z qx qy qz qw");
    const Pose offset = pose(words, 2, Layout::Quaternion);
    if (offset.translation.norm() > 0.0 || rotation_angle(offset.rotation) > 0.0) {
      lines_.fail("the offset is not the identity; move the priors that use it into the frames of their vertices");
    }
    offsets_.insert(lines_.id(words[1]));
  }

  void read_position(const Words& words, int dimension) {
    set_dimension(dimension);
    const std::size_t size = static_cast<std::size_t>(dimension);
    lines_.expect_columns(words, 2 + size + size * (size + 1) / 2,
                          dimension == 2 ? "id x y and 3 information entries of the upper triangle"
                                         : "id x y z and 6 information entries of the upper triangle");
    VertexPrior prior;
    prior.kind = PriorKind::Position;
    for (int k = 0; k < dimension; ++k)
      prior.world_from_frame.translation(k) = lines_.number(words[2 + static_cast<std::size_t>(k)]);
    prior.information = triangle(words, 2 + size, 0, dimension);
    priors_.push_back({lines_.id(words[1]), prior, lines_.line()});
  }

  void read_attitude(const Words& words) {
    set_dimension(3);
    lines_.expect_columns(words, 2 + 4 + 6, "id qx qy qz qw and 6 information entries of the upper triangle");
    VertexPrior prior;
    prior.kind = PriorKind::Attitude;
    prior.world_from_frame.rotation = lines_.quaternion(words, 2);
    prior.information = triangle(words, 6, 3, 3);
    priors_.push_back({lines_.id(words[1]), prior, lines_.line()});
  }

  void set_dimension(int dimension) {
    if (dimension_seen_ && graph_.dimension != dimension) lines_.fail("2-D and 3-D lines in one file; split it in two");
    dimension_seen_ = true;
    graph_.dimension = dimension;
  }

  Pose pose(const Words& words, std::size_t start, Layout layout) const {
    const auto value = [&](std::size_t i) { return lines_.number(words[start + i]); };
    if (dimension_of(layout) == 2) {
      const double half_yaw = 0.5 * value(2);
      return {Eigen::Quaterniond(std::cos(half_yaw), 0.0, 0.0, std::sin(half_yaw)), {value(0), value(1), 0.0}};
    }
    const Eigen::Vector3d translation = lines_.vector(words, start);
    if (layout == Layout::Quaternion) return {lines_.quaternion(words, start + 3), translation};
    return {Eigen::AngleAxisd(value(5), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(value(4), Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(value(3), Eigen::Vector3d::UnitX()),
            translation};
  }

  /// The upper triangle of `size` rows, by rows, set at (first, first).
  Matrix6d triangle(const Words& words, std::size_t start, int first, int size) {
    Matrix6d result = Matrix6d::Zero();
    result.block(first, first, size, size) = lines_.triangle(words, start, size);
    return result;
  }

  Matrix6d information(const Words& words, std::size_t start, Layout layout) {
    if (dimension_of(layout) == 3) return triangle(words, start, 0, 6);
    using Entries = std::array<std::pair<int, int>, 6>;
    constexpr Entries kByRows = {{{0, 0}, {0, 1}, {0, 5}, {1, 1}, {1, 5}, {5, 5}}};
    constexpr Entries kToro = {{{0, 0}, {0, 1}, {1, 1}, {5, 5}, {0, 5}, {1, 5}}};
    Matrix6d result = Matrix6d::Zero();
    for (const auto& [row, column] : layout == Layout::PlanarToro ? kToro : kByRows) {
      result(row, column) = result(column, row) = lines_.number(words[start++]);
    }
    lines_.check_information(planar_information(result));
    return result;
  }

  void finish() {
    const bool chain = graph_.vertices.empty();
    if (chain) {
      std::set<std::int64_t> ids;
      for (const PendingEdge& edge : edges_) ids.insert({edge.from_id, edge.to_id});
      for (const std::int64_t vertex_id : ids) {
        lines_.add_vertex(vertex_id);
        graph_.vertices.push_back({vertex_id, {}, false});
      }
    }
    for (const std::size_t v : lines_.fixed()) graph_.vertices[v].fixed = true;
    for (PendingEdge& pending : edges_) {
      pending.edge.from = lines_.position(pending.from_id, pending.line);
      pending.edge.to = lines_.position(pending.to_id, pending.line);
      graph_.edges.push_back(pending.edge);
    }
    for (PendingPrior& pending : priors_) {
      pending.prior.vertex = lines_.position(pending.id, pending.line);
      graph_.priors.push_back(pending.prior);
    }
    if (chain) {
      chain_along_edges(graph_);
      move_to_priors(graph_);
    }
    lines_.warn(chain, edges_.size() + priors_.size());
  }

  const std::filesystem::path& path_;
  LineReader lines_;
  bool dimension_seen_ = false;
  PoseGraph graph_;
  std::vector<PendingEdge> edges_;
  std::vector<PendingPrior> priors_;
  std::set<std::int64_t> offsets_;  ///< Ids of PARAMS_SE3OFFSET, all of them the identity.
};

}  // namespace

PoseGraph read_g2o(const std::filesystem::path& path, const G2oOptions& options) { return Reader(path, options).read(); }

}  // namespace fabloop
