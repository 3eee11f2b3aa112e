// SPDX-License-Identifier: BSD-3-Clause
#include "apps/live_run.h"

#include <charconv>
#include <chrono>
#include <exception>
#include <iostream>
#include <string>
#include <system_error>
#include <utility>

#include "apps/live/live_json.h"
#include "apps/live/live_sources.h"
#include "apps/report_page.h"

namespace fabloop::apps {
namespace {

/// For pages to ask how it ended and to fetch the report, on a busy machine.
constexpr auto kMostWait = std::chrono::seconds(5);

/// The page of a run that has only begun.
std::string live_page(const LiveFeed& feed, const std::string& title, const std::filesystem::path& out, LiveShows shows) {
  nlohmann::ordered_json data;
  data["live"] = {{"run", feed.latest()->run},
                  {"folder", std::filesystem::absolute(out).lexically_normal().string()},
                  {"shows", shows == LiveShows::Map ? "map" : "progress"},
                  {"verdicts", live_verdicts()}};
  data["summary"] = {{"sequence", title}};
  data["frames"] = nlohmann::ordered_json::array();
  const auto none = nlohmann::ordered_json::array();
  data["map"] = {{"unit", "m"}, {"up", {0, 0, 1}}, {"final", none}, {"odometry", none}, {"points", nullptr}};
  data["ledger"] = {{"query", none}, {"match", none}, {"verdict", none}, {"inliers", none}};
  for (const char* unknown : {"truth", "images", "inliers"}) data[unknown] = nullptr;
  return report_page(title, data);
}

/// "PORT", or "" for none.
std::string take_port(const std::string& text, LiveArguments& arguments) {
  constexpr int kLargest = 65535;
  arguments.is_asked = true;
  if (text.empty()) return "";
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), arguments.port);
  const bool is_port =
      error == std::errc() && end == text.data() + text.size() && arguments.port >= 0 && arguments.port <= kLargest;
  return is_port ? "" : "'" + text + "' is no port (0 to 65535; 0: any that is free). What comes after --live is taken for one";
}

}  // namespace

void add_live_argument(CLI::App* command, LiveArguments& arguments) {
  const CLI::callback_t take = [&arguments](const CLI::results_t& words) {
    const std::string wrong = take_port(words.empty() ? std::string() : words.front(), arguments);
    if (!wrong.empty()) throw CLI::ValidationError("--live", wrong);
    return true;
  };
  command
      ->add_option(
          "--live", take,
          "serve a page that shows the run while it goes on, to browsers of this machine alone, on this port (default: any "
          "that is free)")
      ->expected(0, 1)
      ->type_name("[PORT]");
}

LiveRun::LiveRun(const LiveArguments& arguments, const std::string& title, const std::filesystem::path& out, LiveShows shows) {
  if (!arguments.is_asked) return;
  feed_ = std::make_shared<LiveFeed>();
  server_ = std::make_unique<LiveServer>(*feed_, live_page(*feed_, title, out, shows), arguments.port);
  std::cout << "live view: http://127.0.0.1:" << server_->port() << '/' << std::endl;
}

Progress LiveRun::progress(Progress also) const {
  if (!feed_) return also;
  return [feed = feed_, also = std::move(also)](std::string_view stage, std::size_t done, std::size_t total) {
    feed->tell_progress(stage, done, total);
    if (also) also(stage, done, total);
  };
}

WatchMap LiveRun::watch_map() const {
  if (!feed_) return {};
  return [feed = feed_](const Map& map) {
    // The finished map has what is not yet known of the others.
    if (!map.final_trajectory.empty() || feed->is_map_due()) feed->show(live_map_of(map));
  };
}

WatchPlaced LiveRun::watch_placed() const {
  if (!feed_) return {};
  return [feed = feed_, most = std::size_t{0}](const PlacedSoFar& so_far) mutable {
    const bool is_placing = so_far.stage == "placing";
    if (!is_placing) feed->tell_progress(so_far.stage, 0, 0);
    if (is_placing && !feed->is_map_due()) return;
    const std::size_t placed = num_placed(so_far.segment);
    if (placed < most) return;  // one that is smaller than what is shown
    most = placed;
    feed->show(live_map_of(so_far));
  };
}

void LiveRun::begin_stage(const char* stage) const {
  if (feed_) feed_->tell_progress(stage, 0, 0);
}

void LiveRun::until_end_of(const std::function<std::filesystem::path()>& work) {
  if (!feed_) {
    work();
    return;
  }
  try {
    feed_->end(work());
  } catch (const std::exception& error) {
    feed_->fail(error.what());
    server_->wait_for_pages(kMostWait);
    throw;
  }
  server_->wait_for_pages(kMostWait);
}

}  // namespace fabloop::apps
