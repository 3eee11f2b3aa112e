// SPDX-License-Identifier: BSD-3-Clause
#include "verification/async_loop_closer.h"

#include <algorithm>
#include <utility>

#include "frontend/error.h"

namespace fabloop {
namespace {

/// A cv::Mat shares its numbers with the one that it was copied from.
void own_buffers(Keyframe& keyframe) {
  keyframe.image = keyframe.image.clone();
  keyframe.depth = keyframe.depth.clone();
  if (keyframe.features) keyframe.features->descriptors = keyframe.features->descriptors.clone();
}

}  // namespace

const LoopEvent& AsyncResult::get() const {
  if (error) std::rethrow_exception(error);
  return *event;
}

AsyncLoopCloser::AsyncLoopCloser(LoopCloser loop_closer, const AsyncOptions& options)
    : loop_closer_(std::move(loop_closer)), options_(options) {
  if (options_.max_queue == 0) throw InputError("the loop closer's queue has room for no keyframe; give max_queue at least 1");
  worker_ = std::thread([this] { work(); });
}

AsyncLoopCloser::~AsyncLoopCloser() {
  {
    const std::lock_guard lock(mutex_);
    queue_.clear();
    is_stopping_ = true;
  }
  has_work_.notify_all();
  has_changed_.notify_all();
  worker_.join();
}

bool AsyncLoopCloser::submit(Keyframe keyframe) {
  Pending pending{std::move(keyframe), 0, Clock::now()};
  own_buffers(pending.keyframe);
  {
    std::unique_lock lock(mutex_);
    const auto has_room = [this] { return queue_.size() < options_.max_queue; };
    if (options_.back_pressure == BackPressure::Block) {
      has_changed_.wait(lock, [&] { return has_room() || is_stopping_; });
    }
    pending.number = ++num_offered_;
    if (!has_room()) {
      if (options_.back_pressure == BackPressure::Reject) {
        ++statistics_.num_rejected;
        return false;
      }
      queue_.pop_front();
      ++statistics_.num_dropped;
    }
    queue_.push_back(std::move(pending));
    ++statistics_.num_submitted;
    statistics_.max_queue_length = std::max(statistics_.max_queue_length, queue_.size());
  }
  has_work_.notify_one();
  return true;
}

std::optional<AsyncResult> AsyncLoopCloser::poll() {
  const std::lock_guard lock(mutex_);
  return next_result();
}

std::optional<AsyncResult> AsyncLoopCloser::wait_next() {
  std::unique_lock lock(mutex_);
  has_changed_.wait(lock, [this] { return !results_.empty() || is_idle(); });
  return next_result();
}

std::optional<AsyncResult> AsyncLoopCloser::next_result() {
  if (results_.empty()) return std::nullopt;
  AsyncResult result = std::move(results_.front());
  results_.pop_front();
  return result;
}

void AsyncLoopCloser::flush() {
  std::unique_lock lock(mutex_);
  has_changed_.wait(lock, [this] { return is_idle(); });
  if (callback_error_) std::rethrow_exception(std::exchange(callback_error_, nullptr));
}

std::size_t AsyncLoopCloser::cancel() {
  std::size_t num_cancelled = 0;
  {
    const std::lock_guard lock(mutex_);
    num_cancelled = queue_.size();
    statistics_.num_cancelled += num_cancelled;
    queue_.clear();
  }
  has_changed_.notify_all();
  return num_cancelled;
}

AsyncStatistics AsyncLoopCloser::statistics() const {
  const std::lock_guard lock(mutex_);
  AsyncStatistics statistics = statistics_;
  statistics.latency = stage_times(latencies_s_);
  return statistics;
}

void AsyncLoopCloser::work() {
  while (std::optional<Pending> pending = take()) deliver(process(std::move(*pending)));
}

std::optional<AsyncLoopCloser::Pending> AsyncLoopCloser::take() {
  std::optional<Pending> pending;
  {
    std::unique_lock lock(mutex_);
    has_work_.wait(lock, [this] { return !queue_.empty() || is_stopping_; });
    if (is_stopping_) return std::nullopt;
    pending = std::move(queue_.front());
    queue_.pop_front();
    is_busy_ = true;
  }
  has_changed_.notify_all();
  return pending;
}

AsyncResult AsyncLoopCloser::process(Pending pending) {
  AsyncResult result;
  result.frame = pending.keyframe.frame;
  if (pending.number != last_number_ + 1) pending.keyframe.step_covariance.reset();
  try {
    result.event = loop_closer_.add_keyframe(pending.keyframe);
    last_number_ = pending.number;
  } catch (...) {
    result.error = std::current_exception();
  }
  result.latency_s = std::chrono::duration<double>(Clock::now() - pending.since).count();
  return result;
}

void AsyncLoopCloser::deliver(AsyncResult result) {
  std::exception_ptr callback_error;
  if (options_.on_result) {
    try {
      options_.on_result(result);
    } catch (...) {
      callback_error = std::current_exception();
    }
  }
  {
    const std::lock_guard lock(mutex_);
    ++statistics_.num_processed;
    statistics_.num_failed += result.error != nullptr;
    latencies_s_.push_back(result.latency_s);
    if (!callback_error_) callback_error_ = callback_error;
    if (!options_.on_result) results_.push_back(std::move(result));
    is_busy_ = false;
  }
  has_changed_.notify_all();
}

}  // namespace fabloop
