// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/exif.h"

#include <libexif/exif-data.h>
#include <libexif/exif-utils.h>

#include <cmath>
#include <memory>
#include <sstream>
#include <vector>

namespace fabloop {
namespace {

struct FreeExif {
  void operator()(ExifData* data) const { exif_data_unref(data); }
};

double rational_at(const unsigned char* bytes, ExifByteOrder order, bool is_signed) {
  if (is_signed) {
    const ExifSRational value = exif_get_srational(bytes, order);
    return value.denominator == 0 ? 0.0 : static_cast<double>(value.numerator) / value.denominator;
  }
  const ExifRational value = exif_get_rational(bytes, order);
  return value.denominator == 0 ? 0.0 : static_cast<double>(value.numerator) / value.denominator;
}

/// The tag's positive number, whatever its type; none when it is absent, damaged or not positive.
std::optional<double> positive_number(ExifData& data, ExifTag tag) {
  const ExifEntry* entry = nullptr;
  for (const ExifIfd ifd : {EXIF_IFD_EXIF, EXIF_IFD_0}) {
    if (entry == nullptr) entry = exif_content_get_entry(data.ifd[ifd], tag);
  }
  if (entry == nullptr || entry->data == nullptr || entry->components < 1) return std::nullopt;
  if (entry->size < exif_format_get_size(entry->format)) return std::nullopt;
  const ExifByteOrder order = exif_data_get_byte_order(&data);
  double value = 0;
  switch (entry->format) {
    case EXIF_FORMAT_SHORT:
      value = exif_get_short(entry->data, order);
      break;
    case EXIF_FORMAT_LONG:
      value = exif_get_long(entry->data, order);
      break;
    case EXIF_FORMAT_RATIONAL:
      value = rational_at(entry->data, order, false);
      break;
    case EXIF_FORMAT_SRATIONAL:
      value = rational_at(entry->data, order, true);
      break;
    default:
      break;
  }
  return value > 0 && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// EXIF 2.3, FocalPlaneResolutionUnit: 2 is the inch (and the default), 3 the centimetre; 4 and 5 are common extensions.
double millimetres_of_unit(int unit) {
  switch (unit) {
    case 3:
      return 10.0;
    case 4:
      return 1.0;
    case 5:
      return 0.001;
    default:
      return 25.4;
  }
}

/// Width of the sensor in millimetres, where a plausible one follows from the focal-plane resolution.
std::optional<double> sensor_width_mm(ExifData& data) {
  const auto pixels_per_unit = positive_number(data, EXIF_TAG_FOCAL_PLANE_X_RESOLUTION);
  const auto sensor_width_px = positive_number(data, EXIF_TAG_PIXEL_X_DIMENSION);
  if (!pixels_per_unit || !sensor_width_px) return std::nullopt;
  const auto unit = static_cast<int>(positive_number(data, EXIF_TAG_FOCAL_PLANE_RESOLUTION_UNIT).value_or(2));
  const double width_mm = *sensor_width_px / *pixels_per_unit * millimetres_of_unit(unit);
  return width_mm > 1.0 && width_mm < 100.0 ? std::optional(width_mm) : std::nullopt;
}

/// Focal length in pixels of the image. The 35-mm equivalent is rounded to a millimetre but survives resizing, after which the
/// focal-plane resolution may speak of other pixels: the latter is taken when the two roughly agree.
std::optional<double> focal_px(ExifData& data, int width, int height) {
  const auto focal_mm = positive_number(data, EXIF_TAG_FOCAL_LENGTH);
  const auto focal_35mm = positive_number(data, EXIF_TAG_FOCAL_LENGTH_IN_35MM_FILM);
  std::optional<double> from_sensor, from_35mm;
  if (const auto sensor_mm = sensor_width_mm(data); sensor_mm && focal_mm) from_sensor = *focal_mm / *sensor_mm * width;
  // CIPA DCG-001: equivalent by the diagonal, which is 43.27 mm on 36 x 24 mm film.
  if (focal_35mm) from_35mm = *focal_35mm / std::hypot(36.0, 24.0) * std::hypot(width, height);
  if (!from_sensor || !from_35mm) return from_sensor ? from_sensor : from_35mm;
  constexpr double kRoughly = 0.15;
  return std::abs(*from_sensor / *from_35mm - 1) < kRoughly ? from_sensor : from_35mm;
}

/// The text of a tag of the image, without spaces and zeros at its end; empty when it is absent.
std::string text_of(ExifData& data, ExifTag tag) {
  const ExifEntry* entry = exif_content_get_entry(data.ifd[EXIF_IFD_0], tag);
  if (entry == nullptr || entry->data == nullptr || entry->format != EXIF_FORMAT_ASCII) return {};
  std::string text(reinterpret_cast<const char*>(entry->data), entry->size);
  text = text.substr(0, text.find('\0'));
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

const ExifEntry* gps_entry(ExifData& data, int tag) {
  const ExifEntry* entry = exif_content_get_entry(data.ifd[EXIF_IFD_GPS], static_cast<ExifTag>(tag));
  return entry != nullptr && entry->data != nullptr ? entry : nullptr;
}

/// The rationals of a GPS tag; none when there are fewer, or a damaged one.
std::optional<std::vector<double>> gps_numbers(ExifData& data, int tag, std::size_t count) {
  const ExifEntry* entry = gps_entry(data, tag);
  const std::size_t size = exif_format_get_size(EXIF_FORMAT_RATIONAL);
  if (entry == nullptr || entry->format != EXIF_FORMAT_RATIONAL || entry->size < count * size) return std::nullopt;
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    const ExifRational value = exif_get_rational(entry->data + i * size, exif_data_get_byte_order(&data));
    if (value.denominator == 0) return std::nullopt;
    numbers.push_back(static_cast<double>(value.numerator) / value.denominator);
  }
  return numbers;
}

/// Degrees, minutes and seconds as EXIF has them, with the sign that the reference letter tells.
std::optional<double> gps_degrees(ExifData& data, int tag, int reference_tag, char negative) {
  const auto parts = gps_numbers(data, tag, 3);
  const ExifEntry* reference = gps_entry(data, reference_tag);
  if (!parts || reference == nullptr || reference->size < 1) return std::nullopt;
  const double degrees = (*parts)[0] + (*parts)[1] / 60.0 + (*parts)[2] / 3600.0;
  return static_cast<char>(reference->data[0]) == negative ? -degrees : degrees;
}

}  // namespace

std::optional<Camera> camera_from_exif(const std::filesystem::path& image_path, int width, int height) {
  const std::unique_ptr<ExifData, FreeExif> data(exif_data_new_from_file(image_path.c_str()));
  if (!data) return std::nullopt;
  const auto focal = focal_px(*data, width, height);
  if (!focal) return std::nullopt;
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = *focal;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  return camera;
}

std::string to_string(const CameraLabel& label) {
  std::ostringstream text;
  const bool names_maker = !label.model.empty() && label.model.starts_with(label.make);  // many models do
  if (!names_maker) text << label.make << (label.make.empty() || label.model.empty() ? "" : " ");
  text << label.model;
  if (label.focal_mm) text << " at " << *label.focal_mm << " mm";
  return text.str();
}

std::optional<CameraLabel> camera_label_from_exif(const std::filesystem::path& image_path) {
  const std::unique_ptr<ExifData, FreeExif> data(exif_data_new_from_file(image_path.c_str()));
  if (!data) return std::nullopt;
  CameraLabel label{text_of(*data, EXIF_TAG_MAKE), text_of(*data, EXIF_TAG_MODEL),
                    positive_number(*data, EXIF_TAG_FOCAL_LENGTH)};
  if (label.make.empty() && label.model.empty()) return std::nullopt;
  return label;
}

std::optional<GeoPosition> position_from_exif(const std::filesystem::path& image_path) {
  const std::unique_ptr<ExifData, FreeExif> data(exif_data_new_from_file(image_path.c_str()));
  if (!data) return std::nullopt;
  const auto latitude = gps_degrees(*data, EXIF_TAG_GPS_LATITUDE, EXIF_TAG_GPS_LATITUDE_REF, 'S');
  const auto longitude = gps_degrees(*data, EXIF_TAG_GPS_LONGITUDE, EXIF_TAG_GPS_LONGITUDE_REF, 'W');
  const auto altitude = gps_numbers(*data, EXIF_TAG_GPS_ALTITUDE, 1);
  if (!latitude || !longitude || !altitude) return std::nullopt;
  const ExifEntry* below = gps_entry(*data, EXIF_TAG_GPS_ALTITUDE_REF);
  const bool is_below = below != nullptr && below->size >= 1 && below->data[0] == 1;
  return GeoPosition{*latitude, *longitude, is_below ? -altitude->front() : altitude->front()};
}

}  // namespace fabloop
