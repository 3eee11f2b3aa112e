// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "apps/command.h"
#include "apps/lab/lab_run.h"
#include "apps/live_run.h"
#include "apps/progress_bar.h"
#include "apps/run_report.h"

namespace fabloop::apps {
namespace {

struct LabArguments {
  std::string description, out, data;
  int jobs = 0;
  bool parameters = false, fresh = false;
  LiveArguments live;
};

void print_parameters() {
  std::cout << "What a description may set or sweep:\n";
  for (const LabParameter& parameter : lab_parameters()) {
    LabSettings defaults;
    std::cout << "  " << parameter.name << " (" << parameter.of(defaults) << "): " << parameter.what << '\n';
  }
}

void run_experiment(const LabArguments& arguments, const CommonOptions& common) {
  if (arguments.parameters) {
    print_parameters();
    return;
  }
  if (arguments.description.empty() || arguments.out.empty()) throw CLI::RequiredError("a description, and --out");
  const LabDescription description = read_lab_description(arguments.description);
  LabRunOptions options;
  options.data_root = arguments.data;
  options.num_jobs = arguments.jobs > 0 ? arguments.jobs : common.num_threads;
  options.num_threads = common.num_threads;
  if (arguments.fresh) options.if_found = WorkState::IfFound::Discard;
  options.warn = make_warn(common);
  LiveRun live(arguments.live, description.title, arguments.out, LiveShows::Progress);
  options.progress = live.progress(make_progress(common));
  LabRunReport report;
  live.until_end_of([&] {
    report = run_lab(description, arguments.out, options);
    return std::filesystem::path{};
  });
  std::cout << arguments.out << ": " << report.num_cells << " cells";
  if (report.num_there > 0) std::cout << ", of which " << report.num_there << " were there already";
  std::cout << "\nlook at: " << arguments.out << "/table.md, " << arguments.out << "/results.csv\n";
}

}  // namespace

void add_lab_command(CLI::App& program, const CommonOptions& common) {
  const auto arguments = std::make_shared<LabArguments>();
  CLI::App* command = program.add_subcommand(
      "lab", "Run an experiment: data, troubles, methods and stages from one file, to tables and figures; goes on when killed");
  command->add_option("FILE", arguments->description, "description of the experiment (YAML; see apps/lab/README.md)");
  command->add_option("--out", arguments->out, "folder for cells, tables and figures; one that was begun goes on");
  command->add_option("--data", arguments->data, "folder that the description's sequences are in (default: the description's)");
  command->add_option("--jobs", arguments->jobs, "cells run at the same time (default: as many as --threads)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--fresh", arguments->fresh, "remove the cells that are in that folder, and make all anew");
  add_live_argument(command, arguments->live);
  command->add_flag("--parameters", arguments->parameters, "list what a description may set or sweep, and end");
  command->callback([arguments, &common] { run_experiment(*arguments, common); });
}

}  // namespace fabloop::apps
