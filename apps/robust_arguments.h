// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "posegraph/pose_graph.h"
#include "posegraph/robust/robust_optimize.h"

namespace fabloop::apps {

/// How false loops are to be kept from doing harm, as given on the command line.
struct RobustArguments {
  std::string back_end = "none";
  double probability = 0.99;
  std::vector<std::size_t> accept, reject;
  bool as_given = false;
  std::string decisions;
};

/// The names of all back ends.
std::vector<std::string> back_end_names();

/// Adds --robust, --robust-probability, --accept, --reject, --from-poses and --decisions.
void add_robust_arguments(CLI::App* command, RobustArguments& arguments);

/// What robust_optimize() is to be told; its solves are those of `optimize`.
RobustOptions robust_options(const RobustArguments& arguments, const OptimizeOptions& optimize);

/// Whether anything but plain least squares over all edges was asked for.
bool asks_for_back_end(const RobustArguments& arguments);

/// Writes one line an edge: `edge,from,to,kind,chi2,weight,verdict`, with `edge` counted from 0 and `from` and `to` the ids.
/// Throws InputError when it cannot be written.
void write_decisions(const std::filesystem::path& path, const PoseGraph& graph, const RobustReport& report);

}  // namespace fabloop::apps
