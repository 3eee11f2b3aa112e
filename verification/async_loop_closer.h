// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "frontend/stage_times.h"
#include "verification/loop_closer.h"

namespace fabloop {

/// What submit() does when the queue is full.
enum class BackPressure {
  Block,       ///< It waits until there is room: nothing is lost, and the host's thread stalls.
  DropOldest,  ///< The keyframe that has waited longest gives way: the host never waits, results are fresh.
  Reject,      ///< It refuses the new one and says so: the host decides.
};

/// What became of a submitted keyframe.
struct AsyncResult {
  std::size_t frame = 0;           ///< Keyframe::frame.
  std::optional<LoopEvent> event;  ///< None where add_keyframe() threw.
  std::exception_ptr error;        ///< What it threw, or null.
  double latency_s = 0;            ///< From submit() to here.

  /// The event. Throws what add_keyframe() threw.
  const LoopEvent& get() const;
};

struct AsyncOptions {
  std::size_t max_queue = 8;  ///< Keyframes that may wait; at least 1. Bounds memory and, with the time of one, latency.
  BackPressure back_pressure = BackPressure::Block;
  /// Called with each result on the worker's thread, in order. It may use loop_closer(), to save the map say; it must not call
  /// flush(), wait_next(), or submit() under `Block`. What it throws comes out of flush(). Without it results wait for poll() and
  /// wait_next(), however many.
  std::function<void(const AsyncResult&)> on_result{};
};

/// Counts since the beginning.
struct AsyncStatistics {
  std::size_t num_submitted = 0;  ///< Taken by submit().
  std::size_t num_processed = 0;  ///< That have a result, failed ones included.
  std::size_t num_failed = 0;     ///< Whose result is an exception.
  std::size_t num_dropped = 0;    ///< By DropOldest; they have no result.
  std::size_t num_rejected = 0;   ///< By Reject; never taken.
  std::size_t num_cancelled = 0;  ///< By cancel(); they have no result.
  std::size_t max_queue_length = 0;
  StageTimes latency;  ///< From submit() to the result.
};

/// A loop closer on a thread of its own: the host hands keyframes over and goes on. Keyframes give the same events as a
/// LoopCloser gives, in the order in which they were taken. Safe to call from any number of threads.
///
/// Where keyframes are lost (dropped, rejected, cancelled, failed), the next one's `step_covariance` is not used, since it counts
/// from one that was never seen; LoopCloserOptions::odometry stands in.
class AsyncLoopCloser {
 public:
  /// Throws InputError when the queue has no room at all.
  explicit AsyncLoopCloser(LoopCloser loop_closer, const AsyncOptions& options = {});

  /// Cancels what waits, and joins the worker after the keyframe at hand. Call flush() first to have all results.
  ~AsyncLoopCloser();
  AsyncLoopCloser(const AsyncLoopCloser&) = delete;
  AsyncLoopCloser& operator=(const AsyncLoopCloser&) = delete;

  /// Whether the keyframe was taken; false only under `Reject`. Copies images and descriptors, so that hosts may reuse theirs.
  bool submit(Keyframe keyframe);

  /// The next result, if there is one by now.
  std::optional<AsyncResult> poll();

  /// The next result; none once all that was submitted has been handed out.
  std::optional<AsyncResult> wait_next();

  /// Returns when all that was submitted is done. Throws what `on_result` threw first.
  void flush();

  /// Empties the queue and returns how many keyframes that were. The one at hand is finished; new ones may be submitted.
  std::size_t cancel();

  AsyncStatistics statistics() const;

  /// The one within. Only from `on_result`, or after flush() while nobody submits.
  const LoopCloser& loop_closer() const { return loop_closer_; }

 private:
  using Clock = std::chrono::steady_clock;

  struct Pending {
    Keyframe keyframe;
    std::size_t number = 0;  ///< Counts all that were offered, rejected ones too.
    Clock::time_point since;
  };

  void work();
  std::optional<Pending> take();
  AsyncResult process(Pending pending);
  void deliver(AsyncResult result);
  std::optional<AsyncResult> next_result();  ///< With `mutex_` held.
  bool is_idle() const { return queue_.empty() && !is_busy_; }

  LoopCloser loop_closer_;       ///< The worker's.
  std::size_t last_number_ = 0;  ///< The worker's: Pending::number of the last keyframe that was not lost.
  AsyncOptions options_;
  mutable std::mutex mutex_;             ///< Guards all that follows.
  std::condition_variable has_work_;     ///< For the worker.
  std::condition_variable has_changed_;  ///< For those who wait for room, results or the end.
  std::deque<Pending> queue_;
  std::deque<AsyncResult> results_;
  std::size_t num_offered_ = 0;
  AsyncStatistics statistics_;  ///< But for the latency.
  std::vector<double> latencies_s_;
  std::exception_ptr callback_error_;
  bool is_busy_ = false;
  bool is_stopping_ = false;
  std::thread worker_;  ///< Last, so that all it uses is there.
};

}  // namespace fabloop
