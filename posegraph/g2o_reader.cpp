// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "frontend/error.h"
#include "posegraph/connectivity.h"
#include "posegraph/g2o_io.h"
#include "posegraph/g2o_line.h"
#include "posegraph/information.h"
#include "posegraph/initialization.h"

namespace fabloop {
namespace {

using namespace g2o;

/// Files print 6 digits or more, so a unit quaternion is off by far less than this.
constexpr double kMaxQuaternionNormError = 1e-2;

/// A quaternion this close to unit length is left as it is, so that reading what was written gives the same bits.
constexpr double kQuaternionRounding = 1e-14;

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
  Reader(const std::filesystem::path& path, const G2oOptions& options) : path_(path), options_(options) {}

  PoseGraph read() {
    const std::string text = read_text();
    Words words;
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      ++line_;
      split(std::string_view(text).substr(begin, end - begin), words);
      if (!words.empty()) read_line(words);
      begin = end + 1;
    }
    if (graph_.vertices.empty() && edges_.empty()) {
      throw InputError(path_.string() + ": has no vertices and no edges; a .g2o file has lines of " + kKnownTags);
    }
    finish();
    return std::move(graph_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { fail(what, line_); }
  [[noreturn]] void fail(const std::string& what, int line) const {
    throw InputError(path_.string() + ":" + std::to_string(line) + ": " + what);
  }

  std::string read_text() const {
    std::ifstream file(path_, std::ios::binary);
    if (!file || std::filesystem::is_directory(path_)) throw InputError(path_.string() + ": cannot be read; is it a file?");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    if (file.bad()) throw InputError(path_.string() + ": cannot be read to its end");
    return text;
  }

  void read_line(const Words& words) {
    const std::string_view tag = words.front();
    if (tag.front() == '#') return read_comment(words);
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
    if (tag != "FIX") {
      fail("unknown tag " + quoted(tag) + "; known are " + kKnownTags + ": remove or convert the line");
    }
    if (words.size() < 2) fail("FIX has no vertex id; write 'FIX id'");
    for (std::size_t i = 1; i < words.size(); ++i) fixed_.emplace_back(id(words[i]), line_);
  }

  void read_comment(const Words& words) {
    if (words.size() != 3 || words[0] != "#" || words[1] != "kind:") return;
    if (words[2] == "odometry") next_kind_ = EdgeKind::Odometry;
    if (words[2] == "neighbour") next_kind_ = EdgeKind::Neighbour;
    if (words[2] == "loop") next_kind_ = EdgeKind::Loop;
  }

  void read_vertex(const Words& words, Layout layout) {
    set_dimension(dimension_of(layout));
    expect_columns(words, 2 + pose_size(layout), std::string("id ") + pose_columns(layout));
    Vertex vertex;
    vertex.id = id(words[1]);
    vertex.world_from_frame = pose(words, 2, layout);
    if (!position_.emplace(vertex.id, graph_.vertices.size()).second) {
      fail("vertex " + text_of(words[1]) + " is there twice; remove one of its lines");
    }
    graph_.vertices.push_back(vertex);
  }

  void read_edge(const Words& words, Layout layout, bool has_scale) {
    set_dimension(dimension_of(layout));
    const std::size_t information_start = 3 + pose_size(layout);
    expect_columns(words, information_start + information_size(layout),
                   std::string("i j ") + pose_columns(layout) + " and " + std::to_string(information_size(layout)) +
                       " information entries of the upper triangle");
    PendingEdge pending{id(words[1]), id(words[2]), {}, line_};
    if (pending.from_id == pending.to_id) fail("the edge joins vertex " + text_of(words[1]) + " to itself; remove it");
    Edge& edge = pending.edge;
    edge.has_scale = has_scale;
    edge.from_from_to = pose(words, 3, layout);
    if (!has_scale && edge.from_from_to.translation.norm() == 0.0) fail("the direction has length zero; give a unit vector");
    edge.information = information(words, information_start, layout);
    const bool consecutive = pending.to_id - pending.from_id == 1 || pending.from_id - pending.to_id == 1;
    edge.kind = next_kind_.value_or(consecutive ? EdgeKind::Odometry : EdgeKind::Loop);
    next_kind_.reset();
    edges_.push_back(pending);
  }

  /// `start`: the column of the pose.
  void read_prior(const Words& words, Layout layout, std::size_t start) {
    set_dimension(dimension_of(layout));
    expect_columns(words, start + pose_size(layout) + information_size(layout),
                   std::string("id ") + pose_columns(layout) + " and " + std::to_string(information_size(layout)) +
                       " information entries of the upper triangle");
    VertexPrior prior;
    prior.world_from_frame = pose(words, start, layout);
    prior.information = information(words, start + pose_size(layout), layout);
    priors_.push_back({id(words[1]), prior, line_});
  }

  /// g2o writes the id of a PARAMS_SE3OFFSET after the vertex, others do not.
  void read_spatial_prior(const Words& words) {
    constexpr std::size_t kColumnsWithOffset = 3 + 7 + 21;
    if (words.size() != kColumnsWithOffset) return read_prior(words, Layout::Quaternion, 2);
    if (!offsets_.contains(id(words[2]))) fail("there is no PARAMS_SE3OFFSET " + text_of(words[2]) + " before this line");
    read_prior(words, Layout::Quaternion, 3);
  }

  void read_offset(const Words& words) {
    expect_columns(words, 2 + pose_size(Layout::Quaternion), "id x y z qx qy qz qw");
    const Pose offset = pose(words, 2, Layout::Quaternion);
    if (offset.translation.norm() > 0.0 || rotation_angle(offset.rotation) > 0.0) {
      fail("the offset is not the identity; move the priors that use it into the frames of their vertices");
    }
    offsets_.insert(id(words[1]));
  }

  void read_position(const Words& words, int dimension) {
    set_dimension(dimension);
    const std::size_t size = static_cast<std::size_t>(dimension);
    expect_columns(words, 2 + size + size * (size + 1) / 2,
                   dimension == 2 ? "id x y and 3 information entries of the upper triangle"
                                  : "id x y z and 6 information entries of the upper triangle");
    VertexPrior prior;
    prior.kind = PriorKind::Position;
    for (int k = 0; k < dimension; ++k) prior.world_from_frame.translation(k) = number(words[2 + static_cast<std::size_t>(k)]);
    prior.information = triangle(words, 2 + size, 0, dimension);
    priors_.push_back({id(words[1]), prior, line_});
  }

  void read_attitude(const Words& words) {
    set_dimension(3);
    expect_columns(words, 2 + 4 + 6, "id qx qy qz qw and 6 information entries of the upper triangle");
    VertexPrior prior;
    prior.kind = PriorKind::Attitude;
    prior.world_from_frame.rotation = quaternion(words, 2);
    prior.information = triangle(words, 6, 3, 3);
    priors_.push_back({id(words[1]), prior, line_});
  }

  void set_dimension(int dimension) {
    if (dimension_seen_ && graph_.dimension != dimension) fail("2-D and 3-D lines in one file; split it in two");
    dimension_seen_ = true;
    graph_.dimension = dimension;
  }

  void expect_columns(const Words& words, std::size_t count, std::string_view layout) const {
    if (words.size() == count) return;
    const std::string tag(words.front());
    fail(tag + " has " + std::to_string(words.size()) + " columns, not " + std::to_string(count) + "; write '" + tag + " " +
         std::string(layout) + "'");
  }

  std::int64_t id(std::string_view word) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) fail(quoted(word) + " is not a vertex id; give an integer");
    return value;
  }

  double number(std::string_view word) const {
    const char* begin = word.data() + (word.size() > 1 && word.front() == '+' ? 1 : 0);
    double value = 0.0;
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
      fail(quoted(word) + " is not a finite number; correct or remove the line");
    }
    return value;
  }

  Eigen::Quaterniond quaternion(const Words& words, std::size_t start) const {
    const auto value = [&](std::size_t i) { return number(words[start + i]); };
    Eigen::Quaterniond rotation(value(3), value(0), value(1), value(2));
    const double norm_error = std::abs(rotation.norm() - 1.0);
    if (norm_error > kMaxQuaternionNormError) fail("the quaternion (qx qy qz qw) is not of unit length; normalise it");
    if (norm_error > kQuaternionRounding) rotation.normalize();
    return rotation;
  }

  Pose pose(const Words& words, std::size_t start, Layout layout) const {
    const auto value = [&](std::size_t i) { return number(words[start + i]); };
    if (dimension_of(layout) == 2) {
      const double half_yaw = 0.5 * value(2);
      return {Eigen::Quaterniond(std::cos(half_yaw), 0.0, 0.0, std::sin(half_yaw)), {value(0), value(1), 0.0}};
    }
    const Eigen::Vector3d translation(value(0), value(1), value(2));
    if (layout == Layout::Quaternion) return {quaternion(words, start + 3), translation};
    return {Eigen::AngleAxisd(value(5), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(value(4), Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(value(3), Eigen::Vector3d::UnitX()),
            translation};
  }

  /// The upper triangle of `size` rows, by rows, set at (first, first).
  Matrix6d triangle(const Words& words, std::size_t start, int first, int size) {
    Matrix6d result = Matrix6d::Zero();
    for (int i = first; i < first + size; ++i) {
      for (int j = i; j < first + size; ++j) result(i, j) = result(j, i) = number(words[start++]);
    }
    check_information(result, result.block(first, first, size, size));
    return result;
  }

  Matrix6d information(const Words& words, std::size_t start, Layout layout) {
    if (dimension_of(layout) == 3) return triangle(words, start, 0, 6);
    using Entries = std::array<std::pair<int, int>, 6>;
    constexpr Entries kByRows = {{{0, 0}, {0, 1}, {0, 5}, {1, 1}, {1, 5}, {5, 5}}};
    constexpr Entries kToro = {{{0, 0}, {0, 1}, {1, 1}, {5, 5}, {0, 5}, {1, 5}}};
    Matrix6d result = Matrix6d::Zero();
    for (const auto& [row, column] : layout == Layout::PlanarToro ? kToro : kByRows) {
      result(row, column) = result(column, row) = number(words[start++]);
    }
    check_information(result, planar_information(result));
    return result;
  }

  void check_information(const Matrix6d& whole, const Eigen::MatrixXd& block) {
    if (whole.diagonal().minCoeff() < 0.0) {
      fail("the information matrix has a negative entry on its diagonal; give an inverse covariance");
    }
    if (Eigen::LLT<Eigen::MatrixXd>(block).info() == Eigen::Success || is_positive_semidefinite(block)) return;
    if (options_.if_indefinite == G2oOptions::IfIndefinite::Refuse) {
      fail("the information matrix is not positive semi-definite; give an inverse covariance");
    }
    ++num_indefinite_;
  }

  std::size_t position(std::int64_t vertex_id, int line) const {
    const auto found = position_.find(vertex_id);
    if (found == position_.end())
      fail("there is no vertex " + std::to_string(vertex_id) + "; add its line, or remove this one", line);
    return found->second;
  }

  void finish() {
    const bool chain = graph_.vertices.empty();
    if (chain) {
      std::set<std::int64_t> ids;
      for (const PendingEdge& edge : edges_) ids.insert({edge.from_id, edge.to_id});
      for (const std::int64_t vertex_id : ids) {
        position_[vertex_id] = graph_.vertices.size();
        graph_.vertices.push_back({vertex_id, {}, false});
      }
    }
    for (const auto& [vertex_id, line] : fixed_) graph_.vertices[position(vertex_id, line)].fixed = true;
    for (PendingEdge& pending : edges_) {
      pending.edge.from = position(pending.from_id, pending.line);
      pending.edge.to = position(pending.to_id, pending.line);
      graph_.edges.push_back(pending.edge);
    }
    for (PendingPrior& pending : priors_) {
      pending.prior.vertex = position(pending.id, pending.line);
      graph_.priors.push_back(pending.prior);
    }
    if (chain) {
      chain_along_edges(graph_);
      move_to_priors(graph_);
    }
    if (!options_.warn) return;
    if (chain) options_.warn(path_.string() + ": has no vertex lines; poses start from a chain of its edges");
    if (num_indefinite_ == 0) return;
    options_.warn(path_.string() + ": " + std::to_string(num_indefinite_) + " of " +
                  std::to_string(edges_.size() + priors_.size()) +
                  " information matrices are not positive semi-definite; the nearest that are will be used in their place");
  }

  const std::filesystem::path& path_;
  const G2oOptions& options_;
  int line_ = 0;
  bool dimension_seen_ = false;
  PoseGraph graph_;
  std::unordered_map<std::int64_t, std::size_t> position_;
  std::vector<PendingEdge> edges_;
  std::vector<PendingPrior> priors_;
  std::set<std::int64_t> offsets_;  ///< Ids of PARAMS_SE3OFFSET, all of them the identity.
  std::vector<std::pair<std::int64_t, int>> fixed_;
  std::optional<EdgeKind> next_kind_;
  std::size_t num_indefinite_ = 0;
};

}  // namespace

PoseGraph read_g2o(const std::filesystem::path& path, const G2oOptions& options) { return Reader(path, options).read(); }

}  // namespace fabloop
