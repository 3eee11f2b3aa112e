// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {

/// What is written; a zero leaves the field out.
struct ExifFields {
  std::uint32_t focal_length_um = 0;
  std::uint32_t focal_length_35mm = 0;
  std::uint32_t pixel_x_dimension = 0;
  std::uint32_t pixels_per_metre = 0;  ///< Focal-plane resolution, written per centimetre.
  std::string make{}, model{};         ///< Either may be empty.
};

/// Little-endian TIFF directories, as EXIF embeds them (EXIF 2.3, section 4.5).
class TiffBytes {
 public:
  void add_short(std::uint32_t value) { add(value, 2); }
  void add_long(std::uint32_t value) { add(value, 4); }
  void add_entry(std::uint32_t tag, std::uint32_t type, std::uint32_t value, std::uint32_t count = 1) {
    add_short(tag), add_short(type), add_long(count), add_long(value);
  }
  std::vector<std::uint8_t> bytes;

 private:
  void add(std::uint32_t value, int count) {
    for (int i = 0; i < count; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
};

/// The image, a JPEG, with an APP1 segment that holds the fields.
inline std::vector<std::uint8_t> with_exif(std::vector<std::uint8_t> jpeg, const ExifFields& fields) {
  constexpr std::uint32_t kAscii = 2, kShort = 3, kLong = 4, kRational = 5, kNumTexts = 2, kNumEntries = 5, kTextSize = 32;
  constexpr std::uint32_t kTexts = 8 + 2 + 12 * (kNumTexts + 1) + 4, kExifDirectory = kTexts + kNumTexts * kTextSize;
  constexpr std::uint32_t kValues = kExifDirectory + 2 + 12 * kNumEntries + 4;
  TiffBytes tiff;
  tiff.bytes = {'I', 'I', 42, 0};
  tiff.add_long(8);
  tiff.add_short(kNumTexts + 1);
  tiff.add_entry(0x010F, kAscii, kTexts, kTextSize);
  tiff.add_entry(0x0110, kAscii, kTexts + kTextSize, kTextSize);
  tiff.add_entry(0x8769, kLong, kExifDirectory);
  tiff.add_long(0);
  for (std::string text : {fields.make, fields.model}) {
    text.resize(kTextSize, '\0');
    tiff.bytes.insert(tiff.bytes.end(), text.begin(), text.end());
  }
  tiff.add_short(kNumEntries);
  tiff.add_entry(0x920A, kRational, kValues);
  tiff.add_entry(0xA002, kLong, fields.pixel_x_dimension);
  tiff.add_entry(0xA20E, kRational, kValues + 8);
  tiff.add_entry(0xA210, kShort, 3);
  tiff.add_entry(0xA405, kShort, fields.focal_length_35mm);
  tiff.add_long(0);
  tiff.add_long(fields.focal_length_um), tiff.add_long(1000);
  tiff.add_long(fields.pixels_per_metre), tiff.add_long(100);

  const std::vector<std::uint8_t> head{'E', 'x', 'i', 'f', 0, 0};
  const std::size_t length = 2 + head.size() + tiff.bytes.size();
  std::vector<std::uint8_t> segment{0xFF, 0xE1, static_cast<std::uint8_t>(length >> 8), static_cast<std::uint8_t>(length)};
  segment.insert(segment.end(), head.begin(), head.end());
  segment.insert(segment.end(), tiff.bytes.begin(), tiff.bytes.end());
  jpeg.insert(jpeg.begin() + 2, segment.begin(), segment.end());
  return jpeg;
}

/// A small JPEG (64 x 48) with the fields.
inline std::vector<std::uint8_t> jpeg_with_exif(const ExifFields& fields) { return with_exif(encoded_image(".jpg"), fields); }

}  // namespace fabloop
