// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/feature_arguments.h"
#include "apps/progress_bar.h"
#include "frontend/error.h"
#include "frontend/features/feature_picture.h"
#include "frontend/features/feature_report.h"
#include "frontend/features/feature_settings.h"
#include "frontend/features/surf.h"
#include "frontend/output_file.h"
#include "frontend/recognition/plot.h"
#include "frontend/sequence/image_folder.h"
#include "frontend/sequence/sequence.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;

struct FeaturesArguments {
  std::string images;
  std::string out;
  std::vector<std::string> kinds;
  FeatureArguments features;
  std::size_t every = 1;
  std::size_t max_images = 20;
  std::size_t num_pictures = 3;
  bool print_settings = false;
  bool overwrite = false;
};

/// What every kind showed of the images of which pictures are made.
struct Gallery {
  std::vector<std::size_t> images;
  std::vector<std::vector<cv::Mat>> pictures;  ///< One list an image, one picture a kind.
};

std::vector<fs::path> choose_images(const FeaturesArguments& arguments) {
  std::vector<fs::path> all = list_images(fs::path(arguments.images) / "images");
  if (all.empty()) all = list_images(arguments.images);
  if (all.empty()) throw InputError(arguments.images + ": holds no images, nor does its folder images/; give a folder of images");
  std::vector<fs::path> chosen;
  for (std::size_t i = 0; i < all.size() && chosen.size() < arguments.max_images; i += arguments.every) chosen.push_back(all[i]);
  return chosen;
}

/// One set of options for each kind asked for. With "all", kinds that were not built in are left out with a note.
std::vector<FeatureOptions> choose_options(const FeaturesArguments& arguments) {
  FeatureArguments one = arguments.features;
  std::vector<FeatureOptions> chosen;
  const auto choose = [&](const std::string& name) {
    one.features = name;
    chosen.push_back(asked_features(one));
  };
  for (const std::string& name : arguments.kinds) {
    if (name != "all") {
      choose(name);
      continue;
    }
    for (const FeatureKind& kind : default_feature_kinds()) {
      const bool needs_surf = kind.detector == DetectorKind::Surf || kind.descriptor == DescriptorKind::Surf;
      if (needs_surf && surf_library().empty()) {
        std::cerr << "note: " << to_string(kind) << " is left out: this program was built without SURF\n";
      } else {
        choose(to_string(kind));
      }
    }
  }
  if (chosen.empty()) chosen.push_back(asked_features(one));
  return chosen;
}

std::vector<std::size_t> evenly_chosen(std::size_t count, std::size_t wanted) {
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < std::min(count, wanted); ++k) chosen.push_back(k * count / std::min(count, wanted));
  return chosen;
}

void write_text(const fs::path& path, const std::string& text) {
  OutputFile file(path);
  file.stream() << text;
  file.commit();
}

void draw(const std::vector<fs::path>& images, const FeatureKind& kind, const std::vector<SeenImage>& seen, const fs::path& out,
          Gallery& gallery) {
  const std::string name = to_string(kind);
  for (std::size_t k = 0; k < gallery.images.size(); ++k) {
    const std::size_t image = gallery.images[k];
    const std::vector<cv::KeyPoint>& keypoints = seen[image].features.keypoints;
    const std::string title = name + ": " + std::to_string(keypoints.size()) + " features, " +
                              std::to_string(std::lround(1e3 * seen[image].time_s)) + " ms";
    gallery.pictures[k].push_back(draw_features(read_gray_image(images[image]), kind, keypoints, title));
    write_png(out / (images[image].stem().string() + "_" + name + ".png"), gallery.pictures[k].back());
  }
}

void write_montages(const std::vector<fs::path>& images, const Gallery& gallery, const fs::path& out) {
  for (std::size_t k = 0; k < gallery.images.size(); ++k) {
    const auto count = static_cast<double>(gallery.pictures[k].size());
    if (count < 2) return;
    const int columns = static_cast<int>(std::ceil(std::sqrt(count)));
    write_png(out / (images[gallery.images[k]].stem().string() + "_montage.png"), montage(gallery.pictures[k], columns, 800));
  }
}

void run_features(const FeaturesArguments& arguments, const CommonOptions& common) {
  const std::vector<FeatureOptions> kinds = choose_options(arguments);
  if (arguments.print_settings) {
    std::cout << feature_settings_text(kinds.front());
    return;
  }
  if (arguments.images.empty() || arguments.out.empty()) throw CLI::RequiredError("a folder of images, and --out");
  OutputFolder out(arguments.out, arguments.overwrite ? OutputFolder::IfExists::Replace : OutputFolder::IfExists::Refuse);
  const std::vector<fs::path> images = choose_images(arguments);
  const Progress progress = make_progress(common);
  Gallery gallery{evenly_chosen(images.size(), arguments.num_pictures), {}};
  gallery.pictures.resize(gallery.images.size());
  FeatureReportOptions report_options;
  report_options.num_threads = common.num_threads;
  std::vector<FeatureReport> reports;
  for (const FeatureOptions& options : kinds) {
    const std::vector<SeenImage> seen = see_images(
        images.size(), [&](std::size_t i) { return read_gray_image(images[i]); }, options, common.num_threads, progress);
    reports.push_back(report_features(options.kind, seen, report_options));
    draw(images, options.kind, seen, out.part_path(), gallery);
    write_feature_settings(out.part_path() / (to_string(options.kind) + ".yaml"), options);
  }
  write_montages(images, gallery, out.part_path());
  write_text(out.part_path() / "features.csv", report_csv(reports));
  write_text(out.part_path() / "features.md", report_table(reports) + "\n" + report_recipe(report_options) + "\n");
  out.commit();
  std::cout << report_table(reports);
  if (!common.quiet) std::cout << report_recipe(report_options) << "\npictures and table: " << arguments.out << '\n';
}

}  // namespace

void add_features_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<FeaturesArguments>();
  CLI::App* command =
      program.add_subcommand("features", "Pictures of what detectors find in images, and a table of what it is worth");
  command->add_option("IMAGES", arguments->images, "folder with images (itself or in images/), in the order of their names");
  command->add_option("--out", arguments->out, "folder to write pictures (PNG), table (CSV) and settings (YAML) to");
  command
      ->add_option("--features", arguments->kinds,
                   "DETECTOR[+DESCRIPTOR] (default: sift), several to compare, or all: " + detector_names() + " with " +
                       descriptor_names())
      ->check([](const std::string& text) { return text == "all" ? std::string() : check_feature_kind(text); });
  add_feature_option_arguments(command, arguments->features, "");
  command->add_option("--every", arguments->every, "take every Nth image")->check(CLI::PositiveNumber)->capture_default_str();
  command->add_option("--max-images", arguments->max_images, "take at most so many")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--pictures", arguments->num_pictures, "make pictures of so many of them")->capture_default_str();
  command->add_flag("--print-settings", arguments->print_settings,
                    "print the settings that hold, as a file for --settings, and stop");
  command->add_flag("--overwrite", arguments->overwrite, "replace the folder if it exists");
  command->callback([arguments, &common] { run_features(*arguments, common); });
}

}  // namespace fabloop::apps
