// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "frontend/features/feature_options.h"

namespace fabloop {

/// Reads the section `features` of a settings file (YAML), as feature_settings_text() writes it; what is not named there keeps
/// its default. A file with openFABMAP's section `FeatureOptions` is read by read_openfabmap_features(). Throws InputError with
/// file and line for a key that is not known, a value that is none, or options that validate() refuses.
FeatureOptions read_feature_settings(const std::filesystem::path& path);

/// Reads the section `FeatureOptions` of openFABMAP's settings file (OpenCV YAML) and leaves the other sections alone: detector,
/// extractor, static or adaptive mode, and the detectors' own sections. Images are not equalised and SIFT stays SIFT, as there;
/// where openFABMAP has no bound, 10,000 features are one. Throws InputError with file and line.
FeatureOptions read_openfabmap_features(const std::filesystem::path& path);

/// Whether a YAML file has that section. Throws InputError when it is no YAML file.
bool has_openfabmap_features(const std::filesystem::path& path);

/// A settings file with every option, each with what it is.
std::string feature_settings_text(const FeatureOptions& options);

/// Writes it. Throws InputError when that fails.
void write_feature_settings(const std::filesystem::path& path, const FeatureOptions& options);

/// All options as a JSON object, for files that keep them.
std::string feature_options_json(const FeatureOptions& options);

/// The inverse; options that are missing have their default (older files know fewer). Throws InputError for anything else.
FeatureOptions feature_options_from_json(std::string_view json);

/// Sets one option by its key in a settings file ("star.max_size_px"; "none" unsets what may be). A key of "adaptive" turns that
/// on. Throws InputError for a key that is not known and a value that is none; validate() is up to the caller.
void set_feature_option(FeatureOptions& options, const std::string& key, const std::string& value);

/// An option by which two sets of options describe an image differently.
struct OptionDifference {
  std::string option;
  std::string a, b;  ///< Its values.
};

/// The first that differs, of those that matter to the kind of features; none when the same image gives the same features.
std::optional<OptionDifference> first_difference(const FeatureOptions& a, const FeatureOptions& b);

}  // namespace fabloop
