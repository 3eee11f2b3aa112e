// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/sfm/geo_exchange.h"

#include <cassert>
#include <iomanip>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "frontend/output_file.h"
#include "posegraph/sfm/geodesy.h"

namespace fabloop {
namespace {

GeoPosition place_of(const Reconstruction& reconstruction, const PlacedImage& image) {
  assert(reconstruction.origin);
  return geo_from_local(*reconstruction.origin, image.world_from_camera.translation);
}

/// A loop with where its frames are.
struct PlacedLoop {
  LoopLink link;
  GeoPosition query, match;
};

std::vector<PlacedLoop> placed_loops(const Reconstruction& reconstruction, const std::vector<LoopLink>& loops) {
  std::map<std::size_t, const PlacedImage*> image_of;
  for (const PlacedImage& image : reconstruction.images) image_of[image.frame] = &image;
  std::vector<PlacedLoop> placed;
  for (const LoopLink& link : loops) {
    const auto query = image_of.find(link.query);
    const auto match = image_of.find(link.match);
    if (query == image_of.end() || match == image_of.end()) continue;
    placed.push_back({link, place_of(reconstruction, *query->second), place_of(reconstruction, *match->second)});
  }
  return placed;
}

constexpr int kDegreeDigits = 9;  // a tenth of a millimetre
constexpr int kMetreDigits = 3;

/// "longitude,latitude,altitude", as KML has it.
std::string kml_coordinates(const GeoPosition& place) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(kDegreeDigits) << place.longitude_deg << ',' << place.latitude_deg << ','
       << std::setprecision(kMetreDigits) << place.altitude_m;
  return text.str();
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

nlohmann::ordered_json json_coordinates(const GeoPosition& place) {
  return {place.longitude_deg, place.latitude_deg, place.altitude_m};
}

nlohmann::ordered_json line_feature(const nlohmann::ordered_json& coordinates, const nlohmann::ordered_json& properties) {
  return {{"type", "Feature"}, {"properties", properties}, {"geometry", {{"type", "LineString"}, {"coordinates", coordinates}}}};
}

}  // namespace

void write_geo_txt(const std::filesystem::path& path, const Reconstruction& reconstruction) {
  OutputFile file(path);
  file.stream() << "EPSG:4326\n" << std::fixed;
  for (const PlacedImage& image : reconstruction.images) {
    const GeoPosition place = place_of(reconstruction, image);
    file.stream() << image.image_path.filename().string() << ' ' << std::setprecision(kDegreeDigits) << place.longitude_deg << ' '
                  << place.latitude_deg << ' ' << std::setprecision(kMetreDigits) << place.altitude_m << '\n';
  }
  file.commit();
}

void write_track_kml(const std::filesystem::path& path, const Reconstruction& reconstruction, const std::vector<LoopLink>& loops,
                     const std::string& name) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  // KML's colours are alpha, blue, green, red.
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document>\n<name>"
      << escaped(name)
      << "</name>\n<Style id=\"track\"><LineStyle><color>ffc85a14</color><width>3</width></LineStyle></Style>\n"
         "<Style id=\"loop\"><LineStyle><color>9946a028</color><width>1</width></LineStyle></Style>\n"
         "<Placemark>\n<name>track</name>\n<styleUrl>#track</styleUrl>\n<LineString>\n<altitudeMode>absolute</"
         "altitudeMode>\n<coordinates>\n";
  for (const PlacedImage& image : reconstruction.images) out << kml_coordinates(place_of(reconstruction, image)) << '\n';
  out << "</coordinates>\n</LineString>\n</Placemark>\n";
  for (const PlacedLoop& loop : placed_loops(reconstruction, loops)) {
    out << "<Placemark>\n<name>loop " << loop.link.query << " - " << loop.link.match
        << "</name>\n<styleUrl>#loop</styleUrl>\n<LineString>\n<altitudeMode>absolute</altitudeMode>\n<coordinates>"
        << kml_coordinates(loop.query) << ' ' << kml_coordinates(loop.match) << "</coordinates>\n</LineString>\n</Placemark>\n";
  }
  out << "</Document>\n</kml>\n";
  file.commit();
}

void write_track_geojson(const std::filesystem::path& path, const Reconstruction& reconstruction,
                         const std::vector<LoopLink>& loops, const std::string& name) {
  nlohmann::ordered_json track = nlohmann::ordered_json::array();
  for (const PlacedImage& image : reconstruction.images) track.push_back(json_coordinates(place_of(reconstruction, image)));
  nlohmann::ordered_json features = nlohmann::ordered_json::array();
  features.push_back(line_feature(track, {{"kind", "track"}, {"name", name}}));
  for (const PlacedLoop& loop : placed_loops(reconstruction, loops)) {
    nlohmann::ordered_json ends = nlohmann::ordered_json::array();
    ends.push_back(json_coordinates(loop.query));
    ends.push_back(json_coordinates(loop.match));
    features.push_back(line_feature(ends, {{"kind", "loop"}, {"query", loop.link.query}, {"match", loop.link.match}}));
  }
  OutputFile file(path);
  file.stream() << nlohmann::ordered_json{{"type", "FeatureCollection"}, {"features", features}}.dump(1) << '\n';
  file.commit();
}

}  // namespace fabloop
