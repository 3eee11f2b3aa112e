// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "posegraph/pose_graph.h"

/// The words of a .g2o line and how they are laid out (private).
namespace fabloop::g2o {

/// Views into the file's text.
using Words = std::vector<std::string_view>;

/// Splits at blanks; `words` is reused from line to line.
inline void split(std::string_view line, Words& words) {
  constexpr std::string_view kBlanks = " \t\r\v\f";
  words.clear();
  for (std::size_t begin = line.find_first_not_of(kBlanks); begin != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
}

/// How a line writes a pose and its information.
enum class Layout {
  Planar,      ///< x y theta; xx xy xt yy yt tt.
  PlanarToro,  ///< x y theta; xx xy yy tt xt yt.
  Quaternion,  ///< x y z qx qy qz qw; upper triangle by rows.
  EulerToro,   ///< x y z roll pitch yaw, R = Rz(yaw) Ry(pitch) Rx(roll); upper triangle by rows.
};

inline int dimension_of(Layout layout) { return layout == Layout::Planar || layout == Layout::PlanarToro ? 2 : 3; }
inline std::size_t pose_size(Layout layout) { return layout == Layout::Quaternion ? 7 : layout == Layout::EulerToro ? 6 : 3; }
inline std::size_t information_size(Layout layout) { return dimension_of(layout) == 2 ? 6 : 21; }

inline const char* pose_columns(Layout layout) {
  switch (layout) {
    case Layout::Quaternion:
      return "x y z qx qy qz qw";
    case Layout::EulerToro:
      return "x y z roll pitch yaw";
    case Layout::Planar:
    case Layout::PlanarToro:
      return "x y theta";
  }
  return "";
}

inline std::string text_of(std::string_view word) { return std::string(word); }

inline std::string quoted(std::string_view word) {
  std::string result = "'";
  result += word;
  result += '\'';
  return result;
}

/// What an edge is taken for when nothing is said.
inline EdgeKind usual_kind(std::int64_t from_id, std::int64_t to_id) {
  return to_id - from_id == 1 || from_id - to_id == 1 ? EdgeKind::Odometry : EdgeKind::Loop;
}

/// The line before an edge of unusual kind.
inline const char* kind_comment(EdgeKind kind) {
  switch (kind) {
    case EdgeKind::Odometry:
      return "# kind: odometry\n";
    case EdgeKind::Neighbour:
      return "# kind: neighbour\n";
    case EdgeKind::Loop:
      return "# kind: loop\n";
  }
  return "";
}

inline constexpr const char* kKindExplanation =
    "# Edges between consecutive ids are odometry and others are loops, unless a comment 'kind' stands before them.\n";

/// " value" in the fewest digits that read back as the same bits.
inline void write_number(std::ostream& out, double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  out.put(' ').write(buffer.data(), result.ptr - buffer.data());
}

}  // namespace fabloop::g2o
