// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/lab_description.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "apps/lab/strict_yaml.h"
#include "frontend/error.h"
#include "frontend/features/feature_settings.h"

namespace fabloop {
namespace {

constexpr double kMaxMetres = 1e6;

constexpr std::array<Stage, 5> kStages = {Stage::Appearance, Stage::Matching, Stage::Geometry, Stage::Consistency,
                                          Stage::BackEnd};

/// Reads one description.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : file_(read_yaml_file(path)) {
    result_.path = path;
    result_.text = file_.text;
  }

  LabDescription read() {
    read_yaml_map(file_, file_.root, "the description",
                  {{"title", [&](const YAML::Node& n) { result_.title = yaml_text(file_, n, "title"); }},
                   {"data", [&](const YAML::Node& n) { read_data(n); }},
                   {"set", [&](const YAML::Node& n) { read_settings(n); }},
                   {"sweep", [&](const YAML::Node& n) { read_sweep(n); }},
                   {"methods", [&](const YAML::Node& n) { read_methods(n); }},
                   {"stages", [&](const YAML::Node& n) { read_stages(n); }},
                   {"back_ends", [&](const YAML::Node& n) { read_back_ends(n); }},
                   {"features", [&](const YAML::Node& n) { read_features(n); }},
                   {"bootstrap", [&](const YAML::Node& n) { read_bootstrap(n); }}});
    check();
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { file_.fail(YAML::Mark::null_mark(), what); }

  /// Sets a number between the two.
  std::function<void(const YAML::Node&)> number(double& value, const std::string& name, double low, double high) {
    return [this, &value, name, low, high](const YAML::Node& node) { value = yaml_number(file_, node, name, low, high); };
  }

  void read_data(const YAML::Node& node) {
    read_yaml_map(file_, node, "data",
                  {{"synthetic", [&](const YAML::Node& n) { read_synthetic(n); }},
                   {"sequences", [&](const YAML::Node& n) { read_sequences(n); }},
                   {"seeds", [&](const YAML::Node& n) {
                      result_.seeds.clear();
                      for (const YAML::Node& seed : yaml_list(file_, n, "seeds"))
                        result_.seeds.push_back(yaml_whole_number(file_, seed, "a seed"));
                      if (std::set(result_.seeds.begin(), result_.seeds.end()).size() < result_.seeds.size())
                        file_.fail(n.Mark(), "a seed comes twice, and would count twice");
                    }}});
    if (result_.synthetic.has_value() != result_.sequences.empty())
      file_.fail(node.Mark(), "data must be either synthetic or sequences");
  }

  void read_synthetic(const YAML::Node& node) {
    SyntheticData& data = result_.synthetic.emplace();
    read_yaml_map(file_, node, "synthetic",
                  {{"length_m", number(data.length_m, "length_m", 60.0, 20000.0)},
                   {"spacing_m", number(data.spacing_m, "spacing_m", 0.25, 1000.0)},
                   {"mean_height_m", number(data.mean_height_m, "mean_height_m", 12.0, 1000.0)},
                   {"height_spread_m", number(data.height_spread_m, "height_spread_m", 0.0, 1000.0)},
                   {"max_strip_gap_m", number(data.max_strip_gap_m, "max_strip_gap_m", 2.0, 1000.0)},
                   {"texture_m_per_px", number(data.texture_m_per_px, "texture_m_per_px", 0.005, 1.0)},
                   {"height_m_per_px", number(data.height_m_per_px, "height_m_per_px", 0.005, 1.0)},
                   {"camera_scale", number(data.camera_scale, "camera_scale", 0.1, 4.0)},
                   {"tile_m", number(data.tile_m, "tile_m", 4.0, kMaxMetres)}});
  }

  void read_sequences(const YAML::Node& node) {
    for (const YAML::Node& entry : yaml_list(file_, node, "sequences")) {
      SequenceData sequence;
      read_yaml_map(file_, entry, "a sequence",
                    {{"folder", [&](const YAML::Node& n) { sequence.folder = yaml_text(file_, n, "folder"); }},
                     {"earlier", [&](const YAML::Node& n) { sequence.earlier = yaml_text(file_, n, "earlier"); }},
                     {"height_m", number(sequence.height_above_ground_m, "height_m", 0.01, kMaxMetres)}});
      if (sequence.folder.empty()) file_.fail(entry.Mark(), "a sequence needs its folder");
      result_.sequences.push_back(sequence);
    }
  }

  const LabParameter& parameter(const YAML::Node& key, const std::string& what) {
    const std::string name = yaml_text(file_, key, "a key");
    if (const LabParameter* found = lab_parameter(name)) return *found;
    std::string known;
    for (const LabParameter& p : lab_parameters()) known += (known.empty() ? "" : ", ") + std::string(p.name);
    file_.fail(key.Mark(), "'" + name + "' is no key of " + what + "; it knows " + known);
  }

  double value_of(const LabParameter& parameter, const YAML::Node& node) {
    const double value = yaml_number(file_, node, std::string(parameter.name), parameter.low, parameter.high);
    if (parameter.is_whole && value != std::floor(value))
      file_.fail(node.Mark(), std::string(parameter.name) + " must be a whole number");
    return value;
  }

  void read_settings(const YAML::Node& node) {
    if (!node.IsMap()) file_.fail(node.Mark(), "set must be a map of keys and values");
    for (const auto& entry : node) {
      const LabParameter& known = parameter(entry.first, "set");
      require_once(entry.first, std::string(known.name));
      known.of(result_.settings) = value_of(known, entry.second);
    }
  }

  void read_sweep(const YAML::Node& node) {
    if (!node.IsMap()) file_.fail(node.Mark(), "sweep must be a map of keys and lists of values");
    for (const auto& entry : node) {
      LabSweep sweep{&parameter(entry.first, "sweep"), {}};
      require_once(entry.first, std::string(sweep.parameter->name));
      for (const YAML::Node& value : yaml_list(file_, entry.second, std::string(sweep.parameter->name)))
        sweep.values.push_back(value_of(*sweep.parameter, value));
      if (std::set(sweep.values.begin(), sweep.values.end()).size() < sweep.values.size())
        file_.fail(entry.second.Mark(), "a value comes twice, and would count twice");
      result_.sweep.push_back(std::move(sweep));
    }
  }

  /// A parameter is set or swept, and that once.
  void require_once(const YAML::Node& key, const std::string& name) {
    if (!named_.insert(name).second) file_.fail(key.Mark(), "'" + name + "' is set or swept twice");
  }

  void read_methods(const YAML::Node& node) {
    for (const YAML::Node& entry : yaml_list(file_, node, "methods")) {
      LabMethod method;
      if (entry.IsMap()) {
        read_yaml_map(file_, entry, "a method",
                      {{"name", [&](const YAML::Node& n) { method.name = yaml_text(file_, n, "name"); }},
                       {"scores", [&](const YAML::Node& n) { method.scores = yaml_text(file_, n, "scores"); }}});
        if (method.name.empty() || method.scores.empty())
          file_.fail(entry.Mark(), "a method of your own needs a name and the file of its scores");
        if (method.name.find('/') != std::string::npos)
          file_.fail(entry.Mark(), "a method's name is part of file names, so no '/'");
        if (place_method_named(method.name)) file_.fail(entry.Mark(), "'" + method.name + "' is the name of a built-in method");
      } else {
        method.name = yaml_text(file_, entry, "a method");
        method.method = place_method_named(method.name);
        if (!method.method) file_.fail(entry.Mark(), "there is no method '" + method.name + "'; there are " + all_methods());
      }
      for (const LabMethod& other : result_.methods) {
        if (other.name == method.name) file_.fail(entry.Mark(), "the method '" + method.name + "' comes twice");
      }
      if (!method.method) scores_marks_.emplace_back(method, entry.Mark());
      result_.methods.push_back(std::move(method));
    }
  }

  static std::string all_methods() {
    std::string names;
    for (const PlaceMethod method : all_place_methods()) names += std::string(to_string(method)) + ", ";
    return names + "and {name: ..., scores: FILE.csv}";
  }

  void read_stages(const YAML::Node& node) {
    std::set<Stage> wanted;
    for (const YAML::Node& entry : yaml_list(file_, node, "stages")) {
      const std::string name = yaml_text(file_, entry, "a stage");
      const auto found = std::find_if(kStages.begin(), kStages.end(), [&](Stage stage) { return in_words(stage) == name; });
      if (found == kStages.end())
        file_.fail(entry.Mark(),
                   "there is no stage '" + name + "'; there are appearance, matching, geometry, consistency, back end");
      wanted.insert(*found);
    }
    result_.stages.assign(wanted.begin(), wanted.end());
  }

  void read_back_ends(const YAML::Node& node) {
    for (const YAML::Node& entry : yaml_list(file_, node, "back_ends")) {
      const std::string name = yaml_text(file_, entry, "a back end");
      LabBackEnd back_end{name, back_end_named(name)};
      if (!back_end.back_end && name != "map") {
        std::string known = "map";
        for (const BackEnd b : all_back_ends()) known += ", " + std::string(to_string(b));
        file_.fail(entry.Mark(), "there is no back end '" + name + "'; there are " + known);
      }
      for (const LabBackEnd& other : result_.back_ends) {
        if (other.name == name) file_.fail(entry.Mark(), "the back end '" + name + "' comes twice");
      }
      result_.back_ends.push_back(std::move(back_end));
    }
  }

  void read_features(const YAML::Node& node) {
    if (!node.IsMap()) file_.fail(node.Mark(), "features must be a map of options as in a settings file of `fabloop features`");
    for (const auto& entry : node) {
      try {
        set_feature_option(result_.features, yaml_text(file_, entry.first, "a key"), yaml_text(file_, entry.second, "an option"));
      } catch (const InputError& error) {
        file_.fail(entry.first.Mark(), error.what());
      }
    }
    validate(result_.features);
  }

  void read_bootstrap(const YAML::Node& node) {
    BootstrapOptions& options = result_.evaluation.bootstrap;
    read_yaml_map(
        file_, node, "bootstrap",
        {{"resamples", [&](const YAML::Node& n) { options.num_resamples = yaml_whole_number(file_, n, "resamples"); }},
         {"seed", [&](const YAML::Node& n) { options.seed = yaml_whole_number(file_, n, "seed"); }},
         {"confidence", [&](const YAML::Node& n) { options.confidence = yaml_number(file_, n, "confidence", 0.01, 0.9999); }}});
  }

  void check() {
    if (!result_.synthetic && result_.sequences.empty()) fail("has no data; add data with synthetic or sequences");
    if (result_.methods.empty()) fail("has no methods; add methods: [fabmap]");
    if (result_.stages.empty()) fail("has no stages; add stages: [appearance]");
    if (result_.has_stage(Stage::BackEnd) && result_.back_ends.empty()) fail("asks for the back end stage; add back_ends");
    if (!result_.back_ends.empty() && !result_.has_stage(Stage::BackEnd)) fail("has back_ends, but no stage 'back end'");
    const auto is_named = [&](const char* name) { return named_.count(name) > 0; };
    if (!result_.synthetic && (is_named("aliasing") || is_named("drift"))) fail("only synthetic worlds know aliasing and drift");
    if (is_named("random_false_loops") && is_named("grouped_false_loops")) fail("false loops are either random or grouped");
    if (result_.has_stage(Stage::Consistency) && !is_named("consistency"))
      fail("asks for the consistency stage, which is off by default; set or sweep consistency");
    for (const auto& [method, mark] : scores_marks_) require_placeholders(method, mark);
    if (result_.title.empty()) result_.title = result_.path.stem().string();
  }

  /// Scores are by frame numbers, so one file cannot be of two sequences of images.
  void require_placeholders(const LabMethod& method, const YAML::Mark& mark) const {
    for (const SequenceData& sequence : result_.sequences) {
      if (!sequence.earlier.empty())
        file_.fail(mark, "the scores of '" + method.name + "' are of one sequence, and cannot be of an earlier one too");
    }
    const auto require = [&](const std::string& key, const std::string& why) {
      if (method.scores.find('{' + key + '}') != std::string::npos) return;
      file_.fail(mark, "the scores of '" + method.name + "' are of other images " + why + "; give each its own file with {" +
                           key + "} in the path");
    };
    bool is_changed = result_.synthetic.has_value();
    for (const LabParameter& parameter : lab_parameters()) {
      const std::string name(parameter.name);
      if (!parameter.changes_images || named_.count(name) == 0) continue;
      is_changed = true;
      require(name, "where '" + name + "' is set or swept");
    }
    if (is_changed && result_.seeds.size() > 1) require("seed", "with every seed");
    if (result_.sequences.size() > 1) require("data", "with every sequence");
  }

  YamlFile file_;
  LabDescription result_;
  std::vector<std::pair<LabMethod, YAML::Mark>> scores_marks_;  ///< Methods whose scores are files.
  std::set<std::string> named_;
};

}  // namespace

bool LabDescription::has_stage(Stage stage) const { return std::find(stages.begin(), stages.end(), stage) != stages.end(); }

LabDescription read_lab_description(const std::filesystem::path& path) { return Reader(path).read(); }

}  // namespace fabloop
