// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "posegraph/g2o/g2o_io.h"
#include "posegraph/g2o/g2o_line.h"
#include "posegraph/pose_graph.h"

/// What is common to the lines of all .g2o files (private).
namespace fabloop::g2o {

/// Turns words into numbers and ids into positions, and names file and line where that does not go.
class LineReader {
 public:
  /// Keeps references to both.
  LineReader(const std::filesystem::path& path, const G2oOptions& options) : path_(path), options_(options) {}

  /// Calls `read_line` with the words of every line that has some; comments and FIX are dealt with here.
  void read(const std::function<void(const Words&)>& read_line);

  [[noreturn]] void fail(const std::string& what) const { fail(what, line_); }
  [[noreturn]] void fail(const std::string& what, int line) const;
  [[noreturn]] void fail_at_unknown_tag(std::string_view tag, const char* known) const;
  void expect_columns(const Words& words, std::size_t count, std::string_view layout) const;

  int line() const { return line_; }
  std::int64_t id(std::string_view word) const;
  double number(std::string_view word) const;
  Eigen::Vector3d vector(const Words& words, std::size_t start) const;
  /// qx qy qz qw.
  Eigen::Quaterniond quaternion(const Words& words, std::size_t start) const;
  /// A symmetric matrix from its upper triangle by rows, counted where it is indefinite.
  Eigen::MatrixXd triangle(const Words& words, std::size_t start, int size);
  /// Refuses or counts an information matrix.
  void check_information(const Eigen::MatrixXd& information);
  /// Of the edge on this line: what the comment before it says, or its ids.
  EdgeKind take_kind(std::int64_t from_id, std::int64_t to_id);

  /// The vertex on this line is the next in the graph.
  void add_vertex(std::int64_t vertex_id);
  std::size_t num_vertices() const { return position_.size(); }
  /// Of a vertex that `line` speaks of.
  std::size_t position(std::int64_t vertex_id, int line) const;
  /// Positions of what FIX names.
  std::vector<std::size_t> fixed() const;
  /// Tells what was odd in the file as a whole.
  void warn(bool was_chained, std::size_t num_matrices) const;

 private:
  void read_comment(const Words& words);
  std::string text() const;

  const std::filesystem::path& path_;
  const G2oOptions& options_;
  int line_ = 0;
  std::optional<EdgeKind> next_kind_;
  std::size_t num_indefinite_ = 0;
  std::unordered_map<std::int64_t, std::size_t> position_;
  std::vector<std::pair<std::int64_t, int>> fixed_;
};

}  // namespace fabloop::g2o
