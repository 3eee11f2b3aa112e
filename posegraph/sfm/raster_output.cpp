// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/raster_output.h"

#include <geotiff.h>
#include <geotiffio.h>
#include <tiffio.h>
#include <xtiffio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iomanip>
#include <limits>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "frontend/error.h"
#include "frontend/output_file.h"
#include "frontend/recognition/plot.h"

namespace fabloop {
namespace {

constexpr int kTiffTile = 256;
constexpr ttag_t kGdalNoData = 42113;

/// libtiff would print what it has to say.
class SilentTiff {
 public:
  SilentTiff() : error_(TIFFSetErrorHandler(nullptr)), warning_(TIFFSetWarningHandler(nullptr)) {}
  ~SilentTiff() {
    TIFFSetErrorHandler(error_);
    TIFFSetWarningHandler(warning_);
  }
  SilentTiff(const SilentTiff&) = delete;
  SilentTiff& operator=(const SilentTiff&) = delete;

 private:
  TIFFErrorHandler error_, warning_;
};

struct CloseTiff {
  void operator()(TIFF* tiff) const { XTIFFClose(tiff); }
};

/// GDAL's tag for cells without a value, which libtiff does not know.
void declare_no_data_tag(TIFF* tiff) {
  static char name[] = "GDALNoDataValue";
  static const TIFFFieldInfo info = {kGdalNoData, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, name};
  TIFFMergeFieldInfo(tiff, &info, 1);
}

void set_layout(TIFF* tiff, const cv::Mat& raster) {
  const bool is_colour = raster.type() == CV_8UC3;
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, raster.cols);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, raster.rows);
  TIFFSetField(tiff, TIFFTAG_TILEWIDTH, kTiffTile);
  TIFFSetField(tiff, TIFFTAG_TILELENGTH, kTiffTile);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
  TIFFSetField(tiff, TIFFTAG_PREDICTOR, is_colour ? PREDICTOR_HORIZONTAL : PREDICTOR_FLOATINGPOINT);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, is_colour ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, is_colour ? 8 : 32);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, is_colour ? 4 : 1);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, is_colour ? SAMPLEFORMAT_UINT : SAMPLEFORMAT_IEEEFP);
  if (is_colour) {
    const std::array<std::uint16_t, 1> alpha{EXTRASAMPLE_UNASSALPHA};
    TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, alpha.data());
  } else {
    declare_no_data_tag(tiff);
    TIFFSetField(tiff, kGdalNoData, "nan");
  }
}

/// OGC GeoTIFF 1.1: pixels are areas, the tie point is the outer corner of the first one.
bool set_georeference(TIFF* tiff, const GroundGrid& grid, const MapGrid& map) {
  const double cell = grid.spacing * map.scale;
  const std::array<double, 3> scale{cell, cell, 0};
  const double half = 0.5 * grid.spacing;
  const double easting = map.easting_m + map.scale * (grid.first_centre.x() - half);
  const double northing = map.northing_m + map.scale * (grid.first_centre.y() + half);
  const std::array<double, 6> tie_point{0, 0, 0, easting, northing, 0};
  TIFFSetField(tiff, TIFFTAG_GEOPIXELSCALE, 3, scale.data());
  TIFFSetField(tiff, TIFFTAG_GEOTIEPOINTS, 6, tie_point.data());
  const std::unique_ptr<GTIF, decltype(&GTIFFree)> keys(GTIFNew(tiff), &GTIFFree);
  if (!keys) return false;
  GTIFKeySet(keys.get(), GTModelTypeGeoKey, TYPE_SHORT, 1, ModelTypeProjected);
  GTIFKeySet(keys.get(), GTRasterTypeGeoKey, TYPE_SHORT, 1, RasterPixelIsArea);
  GTIFKeySet(keys.get(), ProjectedCSTypeGeoKey, TYPE_SHORT, 1, map.epsg);
  GTIFKeySet(keys.get(), ProjLinearUnitsGeoKey, TYPE_SHORT, 1, Linear_Meter);
  return GTIFWriteKeys(keys.get()) != 0;
}

/// A whole tile's samples; beyond the raster's border they are 0.
std::vector<unsigned char> tile_bytes(const cv::Mat& raster, const cv::Mat1b& shown, int row0, int column0) {
  const bool is_colour = raster.type() == CV_8UC3;
  std::vector<unsigned char> bytes(static_cast<std::size_t>(kTiffTile) * kTiffTile * 4, 0);
  for (int row = row0; row < std::min(raster.rows, row0 + kTiffTile); ++row) {
    for (int column = column0; column < std::min(raster.cols, column0 + kTiffTile); ++column) {
      unsigned char* sample = &bytes[(static_cast<std::size_t>(row - row0) * kTiffTile + (column - column0)) * 4];
      const bool is_shown = shown(row, column) != 0;
      if (is_colour) {
        const auto& bgr = raster.at<cv::Vec3b>(row, column);
        for (int k = 0; k < 3; ++k) sample[k] = is_shown ? bgr[2 - k] : 0;
        sample[3] = is_shown ? 255 : 0;
      } else {
        const float value = is_shown ? raster.at<float>(row, column) : std::numeric_limits<float>::quiet_NaN();
        std::memcpy(sample, &value, sizeof(value));
      }
    }
  }
  return bytes;
}

bool write_tiles(TIFF* tiff, const cv::Mat& raster, const cv::Mat1b& shown) {
  for (int row = 0; row < raster.rows; row += kTiffTile) {
    for (int column = 0; column < raster.cols; column += kTiffTile) {
      std::vector<unsigned char> bytes = tile_bytes(raster, shown, row, column);
      if (TIFFWriteTile(tiff, bytes.data(), static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row), 0, 0) < 0)
        return false;
    }
  }
  return true;
}

}  // namespace

void write_tiff(const std::filesystem::path& path, const GroundGrid& grid, const cv::Mat& raster, const cv::Mat1b& shown,
                const std::optional<MapGrid>& map) {
  const SilentTiff silent;
  std::filesystem::path part = path;
  part += ".part";
  bool complete = false;
  {
    const std::unique_ptr<TIFF, CloseTiff> tiff(XTIFFOpen(part.c_str(), "w"));
    if (tiff) {
      set_layout(tiff.get(), raster);
      complete = (!map || set_georeference(tiff.get(), grid, *map)) && write_tiles(tiff.get(), raster, shown) &&
                 TIFFWriteDirectory(tiff.get()) == 1;
    }
  }
  std::error_code error;
  if (complete) std::filesystem::rename(part, path, error);
  if (complete && !error) return;
  std::filesystem::remove(part, error);
  throw InputError(path.string() + ": could not be written completely; is there space, and may the folder be written?");
}

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  OutputFile file(path);
  file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.commit();
}

void write_png(const std::filesystem::path& path, const cv::Mat3b& colour, const cv::Mat1b& shown) {
  std::vector<cv::Mat> channels;
  cv::split(colour, channels);
  channels.push_back(shown);
  cv::Mat4b picture;
  cv::merge(channels, picture);
  write_png(path, picture);
}

void write_world_file(const std::filesystem::path& path, const GroundGrid& grid) {
  OutputFile file(path);
  file.stream() << std::setprecision(17) << grid.spacing << "\n0\n0\n"
                << -grid.spacing << '\n'
                << grid.first_centre.x() << '\n'
                << grid.first_centre.y() << '\n';
  file.commit();
}

}  // namespace fabloop
