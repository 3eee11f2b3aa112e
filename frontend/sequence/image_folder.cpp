// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/image_folder.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <system_error>

#include "frontend/sequence/trajectory.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 9> kExtensions{".jpg", ".jpeg", ".png", ".tif", ".tiff", ".bmp", ".pgm", ".ppm", ".webp"};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Takes a run of digits from the front, without its leading zeros.
std::string_view take_number(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  std::string_view digits = text.substr(0, end);
  text.remove_prefix(end);
  while (digits.size() > 1 && digits.front() == '0') digits.remove_prefix(1);
  return digits;
}

/// Whether name a comes before b when runs of digits count as numbers; names equal in that sense go by their bytes.
bool name_less(const std::string& name_a, const std::string& name_b) {
  std::string_view a = name_a, b = name_b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view number_a = take_number(a);
      const std::string_view number_b = take_number(b);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
    } else {
      if (a.front() != b.front()) return static_cast<unsigned char>(a.front()) < static_cast<unsigned char>(b.front());
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() != b.empty()) return a.empty();
  return name_a < name_b;
}

}  // namespace

bool is_image_file(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

std::vector<fs::path> list_images(const fs::path& folder) {
  std::vector<fs::path> images;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (is_image_file(entry->path()) && entry->is_regular_file(ignored)) images.push_back(entry->path());
  }
  std::sort(images.begin(), images.end(),
            [](const fs::path& a, const fs::path& b) { return name_less(a.filename().string(), b.filename().string()); });
  return images;
}

std::optional<std::int64_t> time_from_filename(const fs::path& image_path) {
  const std::string stem = image_path.stem().string();
  if (stem.empty() || !is_digit(stem.front())) return std::nullopt;
  const bool only_digits_and_dots = std::all_of(stem.begin(), stem.end(), [](char c) { return is_digit(c) || c == '.'; });
  if (!only_digits_and_dots) return std::nullopt;
  constexpr std::size_t kMostDigitsOfSeconds = 10;
  if (stem.find('.') != std::string::npos || stem.size() <= kMostDigitsOfSeconds) return nanoseconds_from_seconds(stem);
  std::int64_t nanoseconds = 0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), nanoseconds);
  if (error != std::errc() || end != stem.data() + stem.size()) return std::nullopt;
  return nanoseconds;
}

}  // namespace fabloop
