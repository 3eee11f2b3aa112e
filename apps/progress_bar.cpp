// SPDX-License-Identifier: BSD-3-Clause
#include "apps/progress_bar.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>

namespace fabloop::apps {
namespace {

using Clock = std::chrono::steady_clock;

/// Often enough to look alive; seldom enough not to fill a log.
constexpr double kTerminalIntervalS = 0.1;
constexpr double kPlainIntervalS = 10.0;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// "42 s", "3 min 05 s".
std::string duration_text(double seconds) {
  const auto whole = static_cast<long>(std::lround(seconds));
  std::ostringstream text;
  if (whole >= 60) text << whole / 60 << " min " << std::setfill('0') << std::setw(2);
  text << whole % 60 << " s";
  return text.str();
}

class ProgressBar {
 public:
  ProgressBar() : is_terminal_(isatty(STDERR_FILENO) != 0) {}

  void update(std::string_view stage, std::size_t done, std::size_t total) {
    if (stage != stage_ || done < done_) begin(stage);
    done_ = done;
    const bool is_last = done >= total;
    const double interval_s = is_terminal_ ? kTerminalIntervalS : kPlainIntervalS;
    if (finished_ || (!is_last && seconds_since(shown_) < interval_s)) return;
    shown_ = Clock::now();
    is_terminal_ ? draw(done, total) : print(done, total);
    finished_ = is_last;
    if (is_last && is_terminal_) std::cerr << '\n';
  }

 private:
  void begin(std::string_view stage) {
    // A stage that was left unfinished keeps its line.
    if (is_terminal_ && !stage_.empty() && !finished_) std::cerr << '\n';
    stage_ = stage;
    started_ = Clock::now();
    shown_ = is_terminal_ ? Clock::time_point{} : started_;
    finished_ = false;
  }

  /// "12.3/s, 42 s left", or the time that it took.
  std::string pace(std::size_t done, std::size_t total) const {
    const double elapsed_s = seconds_since(started_);
    if (done >= total) return duration_text(elapsed_s);
    if (done == 0 || elapsed_s <= 0) return "";
    const double rate = static_cast<double>(done) / elapsed_s;
    std::ostringstream text;
    text << std::fixed << std::setprecision(rate < 10 ? 1 : 0) << rate << "/s, "
         << duration_text(static_cast<double>(total - done) / rate) << " left";
    return text.str();
  }

  void draw(std::size_t done, std::size_t total) const {
    constexpr int kWidth = 30;
    const int filled = total == 0 ? kWidth : static_cast<int>(kWidth * static_cast<double>(done) / static_cast<double>(total));
    std::cerr << '\r' << std::left << std::setw(20) << stage_ << " [" << std::string(static_cast<std::size_t>(filled), '#')
              << std::string(static_cast<std::size_t>(kWidth - filled), '.') << "] " << done << '/' << total << "  "
              << pace(done, total) << "\x1b[K" << std::flush;
  }

  void print(std::size_t done, std::size_t total) const {
    std::cerr << stage_ << ": " << done << " of " << total;
    const std::string how_fast = pace(done, total);
    if (!how_fast.empty()) std::cerr << " (" << how_fast << ')';
    std::cerr << std::endl;
  }

  bool is_terminal_;
  std::string stage_;
  std::size_t done_ = 0;
  bool finished_ = false;
  Clock::time_point started_;
  Clock::time_point shown_;
};

}  // namespace

Progress make_progress(const CommonOptions& common) {
  if (common.quiet) return {};
  // Shared, because a std::function must be copyable and its copies draw one bar.
  const auto bar = std::make_shared<ProgressBar>();
  return [bar](std::string_view stage, std::size_t done, std::size_t total) { bar->update(stage, done, total); };
}

}  // namespace fabloop::apps
