// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/image_completeness.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace fabloop {
namespace {

constexpr std::array<std::uint8_t, 8> kPngSignature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::uint8_t kMarker = 0xFF, kStartOfImage = 0xD8, kEndOfImage = 0xD9, kStartOfScan = 0xDA, kStuffedZero = 0x00;

/// Markers that stand alone: TEM, RST0 to RST7 and SOI. All others but EOI head a segment with a length.
bool stands_alone(std::uint8_t marker) { return marker == 0x01 || (marker >= 0xD0 && marker <= kStartOfImage); }

/// Position of the next marker in entropy-coded data: FF followed by neither a stuffed zero, a restart nor a fill byte.
std::size_t end_of_scan(std::span<const std::uint8_t> bytes, std::size_t at) {
  for (; at + 1 < bytes.size(); ++at) {
    const std::uint8_t next = bytes[at + 1];
    if (bytes[at] == kMarker && next != kStuffedZero && next != kMarker && !stands_alone(next)) return at;
  }
  return bytes.size();
}

/// Segments are walked, since the end marker of an embedded thumbnail is not the image's.
bool is_complete_jpeg(std::span<const std::uint8_t> bytes) {
  std::size_t at = 2;
  while (at + 1 < bytes.size()) {
    const std::uint8_t marker = bytes[at + 1];
    if (bytes[at] != kMarker) return false;
    if (marker == kEndOfImage) return true;
    if (marker == kMarker) {
      at += 1;
    } else if (stands_alone(marker)) {
      at += 2;
    } else {
      if (at + 3 >= bytes.size()) return false;
      at += 2 + (std::size_t{bytes[at + 2]} << 8 | bytes[at + 3]);
      if (marker == kStartOfScan) at = end_of_scan(bytes, at);
    }
  }
  return false;
}

bool is_complete_png(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kLengthTypeAndCheck = 12;
  std::size_t at = kPngSignature.size();
  while (at + kLengthTypeAndCheck <= bytes.size()) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | bytes[at + i];
    constexpr std::string_view kEnd = "IEND";
    const auto type = bytes.subspan(at + 4, 4);
    if (std::equal(type.begin(), type.end(), kEnd.begin())) return true;
    at += kLengthTypeAndCheck + length;
  }
  return false;
}

}  // namespace

bool is_complete_image(std::span<const std::uint8_t> bytes) {
  if (bytes.size() >= 2 && bytes[0] == kMarker && bytes[1] == kStartOfImage) return is_complete_jpeg(bytes);
  const bool is_png =
      bytes.size() >= kPngSignature.size() && std::equal(kPngSignature.begin(), kPngSignature.end(), bytes.begin());
  return !is_png || is_complete_png(bytes);
}

}  // namespace fabloop
