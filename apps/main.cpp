// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "apps/command.h"
#include "frontend/error.h"

namespace {

constexpr int kBadInput = 1;
constexpr int kWrongUsage = 2;

}  // namespace

int main(int argc, char** argv) {
  using namespace fabloop::apps;
  CLI::App program("fabloop: tells a robot when it has been here before, proves it, and bends its map accordingly.", "fabloop");
  program.require_subcommand(1);
  program.fallthrough();
  CommonOptions common;
  program.add_flag("--quiet", common.quiet, "print only the result and errors");
  program.add_option("--threads", common.num_threads, "number of threads; results do not depend on it (default: all)")
      ->check(CLI::PositiveNumber);
  add_demo_command(program, common);
  add_synth_command(program, common);
  add_keyframes_command(program, common);
  add_features_command(program, common);
  add_train_command(program, common);
  add_recognize_command(program, common);
  add_convert_command(program, common);
  add_verify_command(program);
  add_map_command(program, common);
  add_optimize_command(program, common);
  add_study_command(program);
  add_survey_command(program, common);
  add_surface_command(program, common);
  add_evaluate_command(program);
  add_lab_command(program, common);
  add_report_command(program, common);
  add_explain_command(program);

  // We thread over images and candidates ourselves, so OpenCV's own threads would only compete.
  cv::setNumThreads(1);
  // Its warnings about damaged images would interleave with ours, which name the file.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  // Likewise the video decoder's about damaged frames (-8: none); it has no other switch.
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : kWrongUsage;
  } catch (const fabloop::InputError& error) {
    std::cerr << "fabloop: " << error.what() << '\n';
    return kBadInput;
  } catch (const std::bad_alloc&) {
    std::cerr << "fabloop: out of memory; give fewer images or fewer features\n";
    return kBadInput;
  } catch (const std::exception& error) {
    std::cerr << "fabloop: " << error.what() << '\n';
    return kBadInput;
  }
  return 0;
}
