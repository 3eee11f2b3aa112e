// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

namespace fabloop::apps {

/// Options that every command has.
struct CommonOptions {
  bool quiet = false;   ///< No progress, no notes: only the result and errors.
  int num_threads = 0;  ///< 0: all hardware threads. Results do not depend on it.
};

/// Each adds one command to the program: its options and, as the callback, what it does.
void add_demo_command(CLI::App& program, const CommonOptions& common);
void add_synth_command(CLI::App& program, const CommonOptions& common);
void add_keyframes_command(CLI::App& program, const CommonOptions& common);
void add_features_command(CLI::App& program, const CommonOptions& common);
void add_train_command(CLI::App& program, const CommonOptions& common);
void add_recognize_command(CLI::App& program, const CommonOptions& common);
void add_convert_command(CLI::App& program, const CommonOptions& common);
void add_verify_command(CLI::App& program);
void add_map_command(CLI::App& program, const CommonOptions& common);
void add_optimize_command(CLI::App& program, const CommonOptions& common);
void add_study_command(CLI::App& program);
void add_survey_command(CLI::App& program, const CommonOptions& common);
void add_surface_command(CLI::App& program, const CommonOptions& common);
void add_evaluate_command(CLI::App& program);
void add_lab_command(CLI::App& program, const CommonOptions& common);
void add_report_command(CLI::App& program, const CommonOptions& common);
void add_explain_command(CLI::App& program);

}  // namespace fabloop::apps
