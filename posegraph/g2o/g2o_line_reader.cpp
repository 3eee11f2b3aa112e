// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/g2o/g2o_line_reader.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

#include "frontend/error.h"
#include "posegraph/information.h"

namespace fabloop::g2o {
namespace {

/// Files print 6 digits or more, so a unit quaternion is off by far less than this.
constexpr double kMaxQuaternionNormError = 1e-2;

/// A quaternion this close to unit length is left as it is, so that reading what was written gives the same bits.
constexpr double kQuaternionRounding = 1e-14;

}  // namespace

void LineReader::read(const std::function<void(const Words&)>& read_line) {
  const std::string all = text();
  Words words;
  for (std::size_t begin = 0; begin < all.size();) {
    const std::size_t end = std::min(all.find('\n', begin), all.size());
    ++line_;
    split(std::string_view(all).substr(begin, end - begin), words);
    begin = end + 1;
    if (words.empty()) continue;
    if (words.front().front() == '#') {
      read_comment(words);
    } else if (words.front() == "FIX") {
      if (words.size() < 2) fail("FIX has no vertex id; write 'FIX id'");
      for (std::size_t i = 1; i < words.size(); ++i) fixed_.emplace_back(id(words[i]), line_);
    } else {
      read_line(words);
    }
  }
}

void LineReader::fail(const std::string& what, int line) const {
  throw InputError(path_.string() + ":" + std::to_string(line) + ": " + what);
}

void LineReader::fail_at_unknown_tag(std::string_view tag, const char* known) const {
  fail("unknown tag " + quoted(tag) + "; known are " + known + ": remove or convert the line");
}

void LineReader::expect_columns(const Words& words, std::size_t count, std::string_view layout) const {
  if (words.size() == count) return;
  const std::string tag(words.front());
  fail(tag + " has " + std::to_string(words.size()) + " columns, not " + std::to_string(count) + "; write '" + tag + " " +
       std::string(layout) + "'");
}

std::string LineReader::text() const {
  std::ifstream file(path_, std::ios::binary);
  if (!file || std::filesystem::is_directory(path_)) throw InputError(path_.string() + ": cannot be read; is it a file?");
  std::string all{std::istreambuf_iterator<char>(file), {}};
  if (file.bad()) throw InputError(path_.string() + ": cannot be read to its end");
  return all;
}

void LineReader::read_comment(const Words& words) {
  if (words.size() != 3 || words[0] != "#" || words[1] != "kind:") return;
  if (words[2] == "odometry") next_kind_ = EdgeKind::Odometry;
  if (words[2] == "neighbour") next_kind_ = EdgeKind::Neighbour;
  if (words[2] == "loop") next_kind_ = EdgeKind::Loop;
}

EdgeKind LineReader::take_kind(std::int64_t from_id, std::int64_t to_id) {
  const EdgeKind kind = next_kind_.value_or(usual_kind(from_id, to_id));
  next_kind_.reset();
  return kind;
}

std::int64_t LineReader::id(std::string_view word) const {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) fail(quoted(word) + " is not a vertex id; give an integer");
  return value;
}

double LineReader::number(std::string_view word) const {
  const char* begin = word.data() + (word.size() > 1 && word.front() == '+' ? 1 : 0);
  double value = 0.0;
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    fail(quoted(word) + " is not a finite number; correct or remove the line");
  }
  return value;
}

Eigen::Vector3d LineReader::vector(const Words& words, std::size_t start) const {
  return {number(words[start]), number(words[start + 1]), number(words[start + 2])};
}

Eigen::Quaterniond LineReader::quaternion(const Words& words, std::size_t start) const {
  const auto value = [&](std::size_t i) { return number(words[start + i]); };
  Eigen::Quaterniond rotation(value(3), value(0), value(1), value(2));
  const double norm_error = std::abs(rotation.norm() - 1.0);
  if (norm_error > kMaxQuaternionNormError) fail("the quaternion (qx qy qz qw) is not of unit length; normalise it");
  if (norm_error > kQuaternionRounding) rotation.normalize();
  return rotation;
}

Eigen::MatrixXd LineReader::triangle(const Words& words, std::size_t start, int size) {
  Eigen::MatrixXd result(size, size);
  for (int i = 0; i < size; ++i) {
    for (int j = i; j < size; ++j) result(i, j) = result(j, i) = number(words[start++]);
  }
  check_information(result);
  return result;
}

void LineReader::check_information(const Eigen::MatrixXd& information) {
  if (information.diagonal().minCoeff() < 0.0) {
    fail("the information matrix has a negative entry on its diagonal; give an inverse covariance");
  }
  if (Eigen::LLT<Eigen::MatrixXd>(information).info() == Eigen::Success || is_positive_semidefinite(information)) return;
  if (options_.if_indefinite == G2oOptions::IfIndefinite::Refuse) {
    fail("the information matrix is not positive semi-definite; give an inverse covariance");
  }
  ++num_indefinite_;
}

void LineReader::add_vertex(std::int64_t vertex_id) {
  if (!position_.emplace(vertex_id, position_.size()).second) {
    fail("vertex " + std::to_string(vertex_id) + " is there twice; remove one of its lines");
  }
}

std::size_t LineReader::position(std::int64_t vertex_id, int line) const {
  const auto found = position_.find(vertex_id);
  if (found == position_.end())
    fail("there is no vertex " + std::to_string(vertex_id) + "; add its line, or remove this one", line);
  return found->second;
}

std::vector<std::size_t> LineReader::fixed() const {
  std::vector<std::size_t> result;
  for (const auto& [vertex_id, line] : fixed_) result.push_back(position(vertex_id, line));
  return result;
}

void LineReader::warn(bool was_chained, std::size_t num_matrices) const {
  if (!options_.warn) return;
  if (was_chained) options_.warn(path_.string() + ": has no vertex lines; poses start from a chain of its edges");
  if (num_indefinite_ == 0) return;
  options_.warn(path_.string() + ": " + std::to_string(num_indefinite_) + " of " + std::to_string(num_matrices) +
                " information matrices are not positive semi-definite; the nearest that are will be used in their place");
}

}  // namespace fabloop::g2o
