// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/trajectory.h"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>

#include "frontend/error.h"
#include "frontend/output_file.h"

namespace fabloop {
namespace {

/// Writers print 6 or more digits, so a unit quaternion is off by far less than this.
constexpr double kMaxQuaternionNormError = 1e-2;

std::optional<double> parse_double(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

std::optional<std::int64_t> nanoseconds_from_seconds(std::string_view text) {
  const bool negative = !text.empty() && text.front() == '-';
  if (negative) text.remove_prefix(1);
  const std::size_t dot = text.find('.');
  const std::string_view whole = text.substr(0, dot);
  const std::string_view decimals = dot == std::string_view::npos ? std::string_view() : text.substr(dot + 1);
  std::int64_t seconds = 0;
  const auto [end, error] = std::from_chars(whole.data(), whole.data() + whole.size(), seconds);
  const bool is_plain_decimal = error == std::errc() && end == whole.data() + whole.size() && !whole.empty() &&
                                whole.front() != '-' && decimals.find_first_not_of("0123456789") == std::string_view::npos;
  if (!is_plain_decimal) {
    // Scientific notation, as some writers print it, holds no exact nanoseconds anyway.
    const auto value = parse_double(text);
    constexpr double kMaxSeconds = 9.0e9;
    if (!value || std::abs(*value) > kMaxSeconds || *value < 0) return std::nullopt;
    const auto nanoseconds = static_cast<std::int64_t>(std::llround(*value * 1e9));
    return negative ? -nanoseconds : nanoseconds;
  }
  if (seconds > std::numeric_limits<std::int64_t>::max() / kNanosecondsPerSecond - 1) return std::nullopt;
  std::int64_t fraction = 0;
  std::int64_t scale = kNanosecondsPerSecond;
  for (const char digit : decimals) {
    scale /= 10;
    fraction += scale * (digit - '0');
  }
  const std::int64_t nanoseconds = seconds * kNanosecondsPerSecond + fraction;
  return negative ? -nanoseconds : nanoseconds;
}

std::string seconds_from_nanoseconds(std::int64_t time_ns) {
  const std::uint64_t magnitude =
      time_ns < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(time_ns) : static_cast<std::uint64_t>(time_ns);
  std::string fraction = std::to_string(magnitude % kNanosecondsPerSecond);
  fraction.insert(0, 9 - fraction.size(), '0');
  return (time_ns < 0 ? "-" : "") + std::to_string(magnitude / kNanosecondsPerSecond) + "." + fraction;
}

Trajectory read_tum(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be read; does the file exist?");
  Trajectory trajectory;
  std::string line;
  for (int line_number = 1; std::getline(file, line); ++line_number) {
    const auto fail = [&](const std::string& what) {
      throw InputError(path.string() + ":" + std::to_string(line_number) + ": " + what +
                       "; a TUM line is 't tx ty tz qx qy qz qw'");
    };
    std::istringstream words(line);
    std::string word;
    std::vector<std::string> columns;
    while (words >> word) columns.push_back(word);
    if (columns.empty() || columns.front().front() == '#') continue;
    if (columns.size() != 8) fail("has " + std::to_string(columns.size()) + " columns, not 8");
    const auto time_ns = nanoseconds_from_seconds(columns[0]);
    if (!time_ns) fail("'" + columns[0] + "' is not a time in seconds");
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < v.size(); ++i) {
      const auto value = parse_double(columns[i + 1]);
      if (!value) fail("'" + columns[i + 1] + "' is not a finite number");
      v[i] = *value;
    }
    Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
    if (std::abs(rotation.norm() - 1.0) > kMaxQuaternionNormError) fail("the quaternion is not of unit length");
    if (!trajectory.empty() && *time_ns <= trajectory.back().time_ns) fail("the time does not ascend");
    trajectory.push_back({*time_ns, {rotation.normalized(), {v[0], v[1], v[2]}}});
  }
  if (trajectory.empty()) throw InputError(path.string() + ": has no poses; a TUM line is 't tx ty tz qx qy qz qw'");
  return trajectory;
}

void write_tum(const std::filesystem::path& path, const Trajectory& trajectory) {
  OutputFile file(path);
  file.stream().precision(9);
  file.stream() << std::fixed;
  for (const auto& [time_ns, pose] : trajectory) {
    const auto& t = pose.translation;
    const auto& q = pose.rotation;
    file.stream() << seconds_from_nanoseconds(time_ns) << ' ' << t.x() << ' ' << t.y() << ' ' << t.z() << ' ' << q.x() << ' '
                  << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
  }
  file.commit();
}

}  // namespace fabloop
