// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "frontend/error.h"
#include "posegraph/connectivity.h"
#include "posegraph/g2o_io.h"
#include "posegraph/information.h"

namespace fabloop {
namespace {

/// Files print 6 digits or more, so a unit quaternion is off by far less than this.
constexpr double kMaxQuaternionNormError = 1e-2;

/// A quaternion this close to unit length is left as it is, so that reading what was written gives the same bits.
constexpr double kQuaternionRounding = 1e-14;

constexpr const char* kKnownTags = "VERTEX_SE3:QUAT, EDGE_SE3:QUAT, EDGE_SE3_DIRECTION:QUAT, VERTEX_SE2, EDGE_SE2 and FIX";

using Words = std::vector<std::string>;

/// An edge whose ends are still ids.
struct PendingEdge {
  std::int64_t from_id = 0;
  std::int64_t to_id = 0;
  Edge edge;
  int line = 0;
};

class Reader {
 public:
  Reader(const std::filesystem::path& path, const G2oOptions& options) : path_(path), options_(options) {}

  PoseGraph read() {
    std::ifstream file(path_);
    if (!file) throw InputError(path_.string() + ": cannot be read; does the file exist?");
    std::string text;
    while (std::getline(file, text)) {
      ++line_;
      std::istringstream stream(text);
      Words words;
      for (std::string word; stream >> word;) words.push_back(std::move(word));
      if (!words.empty()) read_line(words);
    }
    if (file.bad()) throw InputError(path_.string() + ": cannot be read to its end; is it a file?");
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

  void read_line(const Words& words) {
    const std::string& tag = words.front();
    if (tag.front() == '#') return read_comment(words);
    if (tag == "VERTEX_SE3:QUAT") return read_vertex(words, 3);
    if (tag == "VERTEX_SE2") return read_vertex(words, 2);
    if (tag == "EDGE_SE3:QUAT") return read_edge(words, 3, true);
    if (tag == "EDGE_SE3_DIRECTION:QUAT") return read_edge(words, 3, false);
    if (tag == "EDGE_SE2") return read_edge(words, 2, true);
    if (tag != "FIX") fail("unknown tag '" + tag + "'; known are " + kKnownTags + ": remove or convert the line");
    if (words.size() < 2) fail("FIX has no vertex id; write 'FIX id'");
    for (std::size_t i = 1; i < words.size(); ++i) fixed_.emplace_back(id(words[i]), line_);
  }

  void read_comment(const Words& words) {
    if (words.size() != 3 || words[0] != "#" || words[1] != "kind:") return;
    if (words[2] == "odometry") next_kind_ = EdgeKind::Odometry;
    if (words[2] == "neighbour") next_kind_ = EdgeKind::Neighbour;
    if (words[2] == "loop") next_kind_ = EdgeKind::Loop;
  }

  void read_vertex(const Words& words, int dimension) {
    set_dimension(dimension);
    const std::size_t pose_size = dimension == 3 ? 7 : 3;
    expect_columns(words, 2 + pose_size, dimension == 3 ? "id x y z qx qy qz qw" : "id x y theta");
    Vertex vertex;
    vertex.id = id(words[1]);
    vertex.world_from_frame = pose(words, 2, dimension);
    if (!position_.emplace(vertex.id, graph_.vertices.size()).second) {
      fail("vertex " + words[1] + " is there twice; remove one of its lines");
    }
    graph_.vertices.push_back(vertex);
  }

  void read_edge(const Words& words, int dimension, bool has_scale) {
    set_dimension(dimension);
    const std::size_t information_start = 3 + (dimension == 3 ? 7 : 3);
    expect_columns(words, information_start + (dimension == 3 ? 21 : 6),
                   dimension == 3 ? "i j x y z qx qy qz qw and 21 upper-triangular information entries"
                                  : "i j x y theta and 6 upper-triangular information entries");
    PendingEdge pending{id(words[1]), id(words[2]), {}, line_};
    if (pending.from_id == pending.to_id) fail("the edge joins vertex " + words[1] + " to itself; remove it");
    Edge& edge = pending.edge;
    edge.has_scale = has_scale;
    edge.from_from_to = pose(words, 3, dimension);
    if (!has_scale && edge.from_from_to.translation.norm() == 0.0) fail("the direction has length zero; give a unit vector");
    edge.information = information(words, information_start, dimension);
    const bool consecutive = pending.to_id - pending.from_id == 1 || pending.from_id - pending.to_id == 1;
    edge.kind = next_kind_.value_or(consecutive ? EdgeKind::Odometry : EdgeKind::Loop);
    next_kind_.reset();
    edges_.push_back(std::move(pending));
  }

  void set_dimension(int dimension) {
    if (dimension_seen_ && graph_.dimension != dimension) fail("2-D and 3-D lines in one file; split it in two");
    dimension_seen_ = true;
    graph_.dimension = dimension;
  }

  void expect_columns(const Words& words, std::size_t count, const char* layout) const {
    if (words.size() == count) return;
    fail(words.front() + " has " + std::to_string(words.size()) + " columns, not " + std::to_string(count) + "; write '" +
         words.front() + " " + layout + "'");
  }

  std::int64_t id(const std::string& word) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) fail("'" + word + "' is not a vertex id; give an integer");
    return value;
  }

  double number(const std::string& word) const {
    const char* begin = word.data() + (word.size() > 1 && word.front() == '+' ? 1 : 0);
    double value = 0.0;
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
      fail("'" + word + "' is not a finite number; correct or remove the line");
    }
    return value;
  }

  Pose pose(const Words& words, std::size_t start, int dimension) const {
    const auto value = [&](std::size_t i) { return number(words[start + i]); };
    if (dimension == 2) {
      const double half_yaw = 0.5 * value(2);
      return {Eigen::Quaterniond(std::cos(half_yaw), 0.0, 0.0, std::sin(half_yaw)), {value(0), value(1), 0.0}};
    }
    Eigen::Quaterniond rotation(value(6), value(3), value(4), value(5));
    const double norm_error = std::abs(rotation.norm() - 1.0);
    if (norm_error > kMaxQuaternionNormError) fail("the quaternion (qx qy qz qw) is not of unit length; normalise it");
    if (norm_error > kQuaternionRounding) rotation.normalize();
    return {rotation, {value(0), value(1), value(2)}};
  }

  Matrix6d information(const Words& words, std::size_t start, int dimension) {
    constexpr std::array<int, 3> kPlanarRows = {0, 1, 5};
    const int size = dimension == 3 ? 6 : 3;
    Matrix6d result = Matrix6d::Zero();
    std::size_t next = start;
    for (int i = 0; i < size; ++i) {
      for (int j = i; j < size; ++j) {
        const int row = dimension == 3 ? i : kPlanarRows[i];
        const int column = dimension == 3 ? j : kPlanarRows[j];
        result(row, column) = result(column, row) = number(words[next++]);
      }
    }
    if (result.diagonal().minCoeff() < 0.0)
      fail("the information matrix has a negative entry on its diagonal; give an inverse covariance");
    if (!is_positive_semidefinite(result)) {
      if (options_.if_indefinite == G2oOptions::IfIndefinite::Refuse) {
        fail("the information matrix is not positive semi-definite; give an inverse covariance");
      }
      ++num_indefinite_;
    }
    return result;
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
      for (const PendingEdge& edge : edges_) position_[edge.from_id] = position_[edge.to_id] = 0;
      for (auto& [vertex_id, at] : position_) {
        at = graph_.vertices.size();
        graph_.vertices.push_back({vertex_id, {}, false});
      }
    }
    for (const auto& [vertex_id, line] : fixed_) graph_.vertices[position(vertex_id, line)].fixed = true;
    for (PendingEdge& pending : edges_) {
      pending.edge.from = position(pending.from_id, pending.line);
      pending.edge.to = position(pending.to_id, pending.line);
      graph_.edges.push_back(pending.edge);
    }
    if (chain) chain_along_edges(graph_);
    if (!options_.warn) return;
    if (chain) options_.warn(path_.string() + ": has no vertex lines; poses start from a chain of its edges");
    if (num_indefinite_ == 0) return;
    options_.warn(path_.string() + ": " + std::to_string(num_indefinite_) + " of " + std::to_string(edges_.size()) +
                  " information matrices are not positive semi-definite; the nearest that are will be used in their place");
  }

  const std::filesystem::path& path_;
  const G2oOptions& options_;
  int line_ = 0;
  bool dimension_seen_ = false;
  PoseGraph graph_;
  std::map<std::int64_t, std::size_t> position_;
  std::vector<PendingEdge> edges_;
  std::vector<std::pair<std::int64_t, int>> fixed_;
  std::optional<EdgeKind> next_kind_;
  std::size_t num_indefinite_ = 0;
};

}  // namespace

PoseGraph read_g2o(const std::filesystem::path& path, const G2oOptions& options) { return Reader(path, options).read(); }

}  // namespace fabloop
