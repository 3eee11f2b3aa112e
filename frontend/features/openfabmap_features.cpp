// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>

#include "frontend/error.h"
#include "frontend/features/feature_settings.h"
#include "frontend/features/yaml_file.h"

namespace fabloop {
namespace {

using Number = std::function<void(double)>;
using Numbers = std::map<std::string, Number>;

constexpr int kBoundWhereTheyHaveNone = 10'000;

template <typename Value>
Number to(Value& field) {
  return [&field](double value) { field = static_cast<Value>(value); };
}

Number ignored() {
  return [](double) {};
}

/// What the numbers of a section set. Those of the other detectors stand in the file too, so a threshold is set only by the
/// section of the chosen one.
class Sections {
 public:
  explicit Sections(FeatureOptions& options) : options_(options) {}

  std::map<std::string, Numbers> all() {
    FeatureOptions& o = options_;
    return {
        {"FastDetector", {{"Threshold", threshold(DetectorKind::Fast)}, {"NonMaxSuppression", to(o.fast.non_max_suppression)}}},
        {"AGAST", {{"Threshold", threshold(DetectorKind::Agast)}, {"NonMaxSuppression", to(o.agast.non_max_suppression)}}},
        {"StarDetector", star()},
        {"SiftDetector",
         {{"EdgeThreshold", to(o.sift.edge_threshold)},
          {"ContrastThreshold", threshold(DetectorKind::Sift)},
          {"NumFeatures", bound(DetectorKind::Sift)},
          {"NumOctaveLayers", to(o.sift.layers_per_octave)},
          {"Sigma", to(o.sift.sigma)}}},
        {"SurfDetector",
         {{"HessianThreshold", threshold(DetectorKind::Surf)},
          {"NumOctaves", to(o.surf.num_octaves)},
          {"NumOctaveLayers", to(o.surf.layers_per_octave)},
          {"Upright", upright()},
          {"Extended", not_extended()}}},
        {"MSERDetector",
         {{"Delta", to(o.mser.delta)},
          {"MinArea", to(o.mser.min_area_px)},
          {"MaxArea", to(o.mser.max_area_px)},
          {"MaxVariation", to(o.mser.max_variation)},
          {"MinDiversity", to(o.mser.min_diversity)},
          {"MaxEvolution", ignored()},  // these four are about colour
          {"AreaThreshold", ignored()},
          {"MinMargin", ignored()},
          {"EdgeBlurSize", ignored()}}},
        {"ORB",
         {{"nFeatures", bound(DetectorKind::Orb)},
          {"scaleFactor", to(o.orb.scale_factor)},
          {"nLevels", to(o.orb.num_levels)},
          {"edgeThreshold", ignored()},  // ours is the patch's size
          {"firstLevel", ignored()},
          {"patchSize", to(o.orb.patch_size_px)}}},
        {"BRISK",
         {{"Threshold", threshold(DetectorKind::Brisk)},
          {"Octaves", to(o.brisk.num_octaves)},
          {"PatternScale", to(o.brisk.pattern_scale)}}},
    };
  }

 private:
  Numbers star() {
    StarOptions& star = options_.star;
    // OpenCV's size is the filter's half width; ours is its width.
    const auto max_size = [&star](double value) { star.max_size_px = 2 * static_cast<int>(value) + 1; };
    const auto suppression = [&star](double value) { star.suppression_px = std::max(3, static_cast<int>(value) | 1); };
    return {{"MaxSize", max_size},
            {"Response", threshold(DetectorKind::Star)},
            {"LineThreshold", to(star.line_threshold)},
            {"LineProjected", to(star.line_threshold)},
            {"LineBinarized", to(star.line_threshold_scale)},
            {"Suppression", suppression}};
  }
  Number threshold(DetectorKind detector) {
    return [this, detector](double value) {
      if (options_.kind.detector == detector) options_.detection_threshold = value;
    };
  }
  Number bound(DetectorKind detector) {
    return [this, detector](double value) {
      if (options_.kind.detector == detector && value > 0) options_.max_features = static_cast<int>(value);
    };
  }
  Number upright() {
    return [this](double value) {
      if (options_.kind.descriptor == DescriptorKind::Surf && value != 0) options_.orientation = Orientation::Upright;
    };
  }
  Number not_extended() {
    return [this](double value) {
      if (options_.kind.descriptor == DescriptorKind::Surf && value != 0)
        throw InputError("SURF descriptors of 128 floats are not known; set Extended: 0 and train with 64");
    };
  }

  FeatureOptions& options_;
};

double number_of(const YamlFile& file, const std::string& name, const YAML::Node& value) {
  try {
    const auto number = value.as<double>();
    if (std::isfinite(number) && std::abs(number) <= 1e9) return number;
  } catch (const YAML::Exception&) {
    // said below
  }
  file.fail(value.Mark(), name + " is no number");
}

std::string lower_case(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

/// The kind that a type's name means; openFABMAP writes them in capitals.
std::string type_name(const YamlFile& file, const YAML::Node& section, const char* key) {
  const YAML::Node value = section[key];
  if (!value.IsDefined() || !value.IsScalar())
    file.fail(section.Mark(), std::string("FeatureOptions has no ") + key + " (\"SURF\", ...)");
  return lower_case(value.Scalar());
}

FeatureKind read_kind(const YamlFile& file, const YAML::Node& section) {
  const std::string detector = type_name(file, section, "DetectorType"), extractor = type_name(file, section, "ExtractorType");
  const auto kind = feature_kind_from_string(detector + "+" + extractor);
  if (!kind) {
    file.fail(section["DetectorType"].Mark(), "features " + detector + "+" + extractor + " are not known; detectors are " +
                                                  detector_names() + ", extractors " + descriptor_names());
  }
  return *kind;
}

void read_adaptive(const YamlFile& file, const YAML::Node& section, FeatureOptions& options) {
  const YAML::Node mode = section["DetectorMode"];
  const std::string name = mode.IsDefined() ? lower_case(mode.Scalar()) : "static";
  if (name != "static" && name != "adaptive") file.fail(mode.Mark(), "DetectorMode is '" + name + "'; give STATIC or ADAPTIVE");
  if (name == "static") return;
  AdaptiveOptions& adaptive = options.adaptive.emplace();
  const Numbers numbers = {{"MinFeatures", to(adaptive.min_features)},
                           {"MaxFeatures", to(adaptive.max_features)},
                           {"MaxIters", to(adaptive.max_iterations)}};
  for (const auto& entry : section["Adaptive"]) {
    const auto key = entry.first.as<std::string>();
    const auto number = numbers.find(key);
    if (number == numbers.end()) file.fail(entry.first.Mark(), "'Adaptive." + key + "' is not known");
    number->second(number_of(file, "Adaptive." + key, entry.second));
  }
  options.max_features = std::max(options.max_features, adaptive.max_features);
}

void read_detectors(const YamlFile& file, const YAML::Node& section, FeatureOptions& options) {
  Sections meanings(options);
  const std::map<std::string, Numbers> sections = meanings.all();
  for (const auto& entry : section) {
    const auto name = entry.first.as<std::string>();
    if (name == "DetectorType" || name == "DetectorMode" || name == "ExtractorType" || name == "Adaptive") continue;
    const auto numbers = sections.find(name);
    if (numbers == sections.end()) file.fail(entry.first.Mark(), "'" + name + "' is no key of openFABMAP's FeatureOptions");
    for (const auto& inner : entry.second) {
      const auto key = inner.first.as<std::string>();
      const auto number = numbers->second.find(key);
      if (number == numbers->second.end()) file.fail(inner.first.Mark(), "'" + name + "." + key + "' is not known");
      try {
        number->second(number_of(file, name + "." + key, inner.second));
      } catch (const InputError& error) {
        if (std::string(error.what()).starts_with(file.path.string())) throw;
        file.fail(inner.first.Mark(), error.what());
      }
    }
  }
}

}  // namespace

bool has_openfabmap_features(const std::filesystem::path& path) {
  const YamlFile file = read_yaml_file(path);
  return file.root["FeatureOptions"].IsDefined();
}

FeatureOptions read_openfabmap_features(const std::filesystem::path& path) {
  const YamlFile file = read_yaml_file(path);
  const YAML::Node section = file.root["FeatureOptions"];
  if (!section.IsDefined() || !section.IsMap()) file.fail(YAML::Mark::null_mark(), "has no section FeatureOptions");
  FeatureOptions options;
  options.max_side_px = kLargestSidePx;
  options.clahe_clip_limit.reset();
  options.root_sift = false;
  options.max_features = kBoundWhereTheyHaveNone;
  try {
    options.kind = read_kind(file, section);
    if (options.kind.detector == DetectorKind::Mser) options.detection_threshold = 0;
    read_detectors(file, section, options);
    read_adaptive(file, section, options);
    validate(options);
  } catch (const YAML::Exception& error) {
    file.fail(error.mark, error.msg);
  } catch (const InputError& error) {
    if (std::string(error.what()).starts_with(path.string())) throw;
    throw InputError(path.string() + ": " + error.what());
  }
  return options;
}

}  // namespace fabloop
