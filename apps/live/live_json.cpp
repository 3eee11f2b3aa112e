// SPDX-License-Identifier: BSD-3-Clause
#include "apps/live/live_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace fabloop::apps {
namespace {

using nlohmann::ordered_json;

/// The number of the last change that fits into one answer.
std::uint64_t last_that_fits(const LiveMap& map, std::uint64_t since, std::size_t max_items) {
  std::vector<std::uint64_t> changes;
  const auto take = [&](const auto& items) {
    for (const auto& item : items) {
      if (item.changed > since) changes.push_back(item.changed);
    }
  };
  take(map.placed);
  take(map.odometry);
  take(map.loops);
  if (changes.size() <= max_items) return map.last_change;
  const auto last = changes.begin() + static_cast<std::ptrdiff_t>(max_items) - 1;
  std::nth_element(changes.begin(), last, changes.end());
  return *last;
}

/// As many digits as can be seen: a ten-thousandth of the decimal power below the map's extent.
class Rounding {
 public:
  explicit Rounding(double extent) {
    constexpr int kDigits = 4;
    if (extent > 0.0) per_unit_ = std::pow(10.0, kDigits - std::floor(std::log10(extent)));
  }
  double operator()(double value) const { return std::round(value * per_unit_) / per_unit_; }

 private:
  double per_unit_ = 1e3;
};

ordered_json track(const std::vector<LivePosition>& positions, std::uint64_t since, std::uint64_t last, const Rounding& rounded) {
  ordered_json numbers = ordered_json::array();
  for (const LivePosition& position : positions) {
    if (position.changed <= since || position.changed > last) continue;
    numbers.push_back(position.frame);
    for (const double value : position.x_in_world) numbers.push_back(rounded(value));
  }
  return numbers;
}

ordered_json loops(const std::vector<LiveLoop>& all, std::uint64_t since, std::uint64_t last) {
  ordered_json numbers = ordered_json::array();
  for (std::size_t row = 0; row < all.size(); ++row) {
    const LiveLoop& loop = all[row];
    if (loop.changed <= since || loop.changed > last) continue;
    numbers.insert(numbers.end(), {row, loop.query, loop.match, static_cast<int>(loop.verdict), loop.num_inliers});
  }
  return numbers;
}

ordered_json stages(const LiveSnapshot& snapshot, LiveClock::time_point now) {
  ordered_json list = ordered_json::array();
  for (const LiveStage& stage : snapshot.stages) {
    const bool is_present = &stage == &snapshot.stages.back();
    const double seconds = stage.seconds_before + (is_present ? std::chrono::duration<double>(now - stage.began).count() : 0.0);
    list.push_back({{"name", stage.name}, {"done", stage.done}, {"total", stage.total}, {"seconds", seconds}});
  }
  return list;
}

ordered_json counts(const LiveMap& map) {
  const auto count = [&](auto predicate) { return std::count_if(map.loops.begin(), map.loops.end(), predicate); };
  return {{"placed", map.placed.size()},
          {"hypotheses", map.loops.size()},
          {"accepted", count([](const LiveLoop& loop) { return loop.verdict == Verdict::Accepted; })},
          {"held_back", count([](const LiveLoop& loop) {
             return loop.verdict == Verdict::Unconfirmed || loop.verdict == Verdict::ContradictsMap;
           })}};
}

const char* name_of(LiveState state) {
  constexpr std::array<const char*, 3> kNames = {"running", "ended", "failed"};
  return kNames.at(static_cast<std::size_t>(state));
}

}  // namespace

ordered_json live_json(const LiveSnapshot& snapshot, std::uint64_t since, LiveClock::time_point now, std::size_t max_items) {
  const LiveMap& map = *snapshot.map;
  if (snapshot.state != LiveState::Running) now = snapshot.ended;
  if (since > map.last_change) since = 0;  // of another run
  const std::uint64_t last = last_that_fits(map, since, max_items);
  const Rounding rounded(map.extent());
  ordered_json json;
  json["run"] = snapshot.run;
  json["state"] = name_of(snapshot.state);
  if (snapshot.state == LiveState::Failed) json["why"] = snapshot.why;
  if (snapshot.state == LiveState::Ended) json["has_report"] = !snapshot.report.empty();
  json["since"] = last;
  json["more"] = last < map.last_change;
  json["elapsed_s"] = std::chrono::duration<double>(now - snapshot.began).count();
  json["stages"] = stages(snapshot, now);
  json["counts"] = counts(map);
  json["world"] = map.world;
  json["unit"] = map.unit;
  json["up"] = {map.up.x(), map.up.y(), map.up.z()};
  json["newest"] = map.newest ? ordered_json(*map.newest) : ordered_json(nullptr);
  json["placed"] = track(map.placed, since, last, rounded);
  json["odometry"] = track(map.odometry, since, last, rounded);
  json["loops"] = loops(map.loops, since, last);
  return json;
}

ordered_json live_verdicts() {
  ordered_json names = ordered_json::array();
  for (int i = 0; i <= static_cast<int>(Verdict::ContradictsMap); ++i)
    names.push_back(std::string(to_string(static_cast<Verdict>(i))));
  return names;
}

}  // namespace fabloop::apps
