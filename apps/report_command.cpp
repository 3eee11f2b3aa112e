// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "apps/command.h"
#include "apps/report_page.h"
#include "frontend/error.h"

namespace fabloop::apps {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  ReportInput input;
  std::optional<double> false_radius_m;
  fs::path out;
};

void run_report(ReportArguments& arguments, const CommonOptions& common) {
  const fs::path& run = arguments.input.truth.run;
  if (!fs::is_directory(run)) throw InputError(run.string() + ": is not a folder; give the folder that a run wrote");
  arguments.input.num_threads = common.num_threads;
  arguments.input.loops.exclusion_window = arguments.input.truth.places.exclusion_window;
  set_false_radius(arguments.input.truth, arguments.input.loops, arguments.false_radius_m);
  const fs::path out = arguments.out.empty() ? run / "report.html" : arguments.out;
  write_report(out, arguments.input);
  if (!common.quiet) std::cout << "look at:     " << out.string() << '\n';
}

}  // namespace

void add_report_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<ReportArguments>();
  ReportInput& input = arguments->input;
  CLI::App* command = program.add_subcommand("report", "One page about a run: its map, its loops and why, how sure, how fast");
  command->add_option("RUN", input.truth.run, "folder that a run wrote")->required();
  command->add_option("--truth", input.truth.truth,
                      "sequence folder, a reference in TUM format, or a loop matrix: judges the stages (see `evaluate`)");
  command->add_option("--images", input.images,
                      "folder of the images (itself or its images/), to show pairs (default: that of --truth)");
  command->add_option("--out", arguments->out, "file to write (default: report.html in the run folder)");
  command
      ->add_option("--height", input.loops.height_above_ground_m,
                   "height above ground, metres; sets what a wrong loop is, and --false-radius")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--radius", input.truth.places.poses.radius_m, "without pairs.csv: camera centres nearer show one place")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option(
          "--false-radius", arguments->false_radius_m,
          "without pairs.csv: camera centres further apart show different places; those between are not judged (default: "
          "three times the height)")
      ->check(CLI::PositiveNumber);
  command->add_option("--window", input.truth.places.exclusion_window, "frames no further apart are neither right nor wrong")
      ->capture_default_str();
  command->callback([arguments, &common] { run_report(*arguments, common); });
}

}  // namespace fabloop::apps
