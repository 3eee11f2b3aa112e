// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/residuals/sparse_solver.h"

#include <ceres/iteration_callback.h>
#ifdef FABLOOP_HAS_OPENMP
#include <omp.h>
#endif
#if __has_include(<dlfcn.h>)
#include <dlfcn.h>
#endif

#include <mutex>
#include <utility>

namespace fabloop::residuals {
namespace {

/// OpenBLAS splits the products of a supernode over all cores, where its threads wait for one another longer than they work, and
/// is not known at compile time: any BLAS may be behind CHOLMOD. Its number of threads belongs to the process, so the first solve
/// sets it and the last of those that run at once gives it back.
class OneBlasThread {
 public:
  OneBlasThread() {
    const std::lock_guard lock(mutex_);
    if (num_solves_++ > 0) return;
    num_threads_ = get() ? get()() : 0;
    if (set()) set()(1);
  }
  ~OneBlasThread() {
    const std::lock_guard lock(mutex_);
    if (--num_solves_ == 0 && set() && num_threads_ > 0) set()(num_threads_);
  }
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;

 private:
  using Get = int (*)();
  using Set = void (*)(int);
#if __has_include(<dlfcn.h>)
  static Get get() { return reinterpret_cast<Get>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads")); }
  static Set set() { return reinterpret_cast<Set>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads")); }
#else
  static Get get() { return nullptr; }
  static Set set() { return nullptr; }
#endif

  static inline std::mutex mutex_;
  static inline int num_solves_ = 0;
  static inline int num_threads_ = 0;
};

/// CHOLMOD adds up its supernodes in four OpenMP threads of its own, which wait for one another longer than they work, and no
/// option of Ceres reaches them. With no level of parallelism allowed, regions run on the thread that meets them.
class OneThread {
 public:
#ifdef FABLOOP_HAS_OPENMP
  OneThread() : levels_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
  ~OneThread() { omp_set_max_active_levels(levels_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int levels_;
#endif
  OneBlasThread blas_;
};

/// Progress, cancelling, and when to stop. The cost falls by a factor of about `ratio` less with each iteration, so what is left
/// to gain is the geometric series that goes on from the last two: one iteration less than waiting for one without gain.
class IterationControl final : public ceres::IterationCallback {
 public:
  explicit IterationControl(const OptimizeOptions& options) : options_(options) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (options_.progress) {
      options_.progress("optimize", static_cast<std::size_t>(summary.iteration),
                        static_cast<std::size_t>(options_.max_iterations));
    }
    cancelled = options_.cancelled && options_.cancelled();
    // "Successfully" makes Ceres hand back the best poses so far.
    return cancelled || has_converged(summary) ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

  bool cancelled = false;

 private:
  bool has_converged(const ceres::IterationSummary& summary) {
    if (!summary.step_is_successful) {
      last_change_ = 0.0;
      return false;
    }
    const double change = std::exchange(last_change_, summary.cost_change);
    // A slow series may hide a slower one.
    constexpr double kMaxRatio = 0.1;
    const double ratio = change > 0.0 ? summary.cost_change / change : 1.0;
    return ratio <= kMaxRatio && summary.cost_change * ratio / (1.0 - ratio) <= options_.cost_tolerance * summary.cost;
  }

  const OptimizeOptions& options_;
  double last_change_ = 0.0;
};

ceres::Solver::Options solver_options(const OptimizeOptions& options, Initialization start) {
  ceres::Solver::Options result;
  result.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  result.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  // Sums over threads would come out in another order each time.
  result.num_threads = 1;
  result.max_num_iterations = options.max_iterations;
  result.function_tolerance = options.cost_tolerance;
  result.gradient_tolerance = 0.0;
  result.parameter_tolerance = 1e-14;
  result.logging_type = ceres::SILENT;
  // Near the optimum damping only holds up the bends that are as long as the map: take Gauss-Newton steps first.
  constexpr double kHardlyDamped = 1e10;
  if (start == Initialization::Chordal) result.initial_trust_region_radius = kHardlyDamped;
  return result;
}

Termination termination_of(const ceres::Solver::Summary& summary, bool cancelled) {
  if (cancelled) return Termination::Cancelled;
  const bool stopped = summary.termination_type == ceres::USER_SUCCESS;
  if (stopped || summary.termination_type == ceres::CONVERGENCE) return Termination::Converged;
  if (summary.termination_type == ceres::NO_CONVERGENCE) return Termination::MaxIterations;
  return Termination::Failed;
}

}  // namespace

SolverRun run(const OptimizeOptions& options, Initialization start, ceres::Problem& problem) {
  const OneThread one_thread;
  ceres::Solver::Options ceres_options = solver_options(options, start);
  IterationControl control(options);
  ceres_options.callbacks.push_back(&control);
  ceres::Solver::Summary summary;
  ceres::Solve(ceres_options, &problem, &summary);
  return {termination_of(summary, control.cancelled), summary.num_successful_steps + summary.num_unsuccessful_steps - 1,
          2.0 * summary.initial_cost, 2.0 * summary.final_cost};
}

}  // namespace fabloop::residuals
