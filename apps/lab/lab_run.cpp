// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lab/lab_run.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "apps/lab/cell_file.h"
#include "apps/lab/lab_cell.h"
#include "apps/lab/lab_figures.h"
#include "apps/lab/lab_results.h"
#include "apps/lab/lab_tables.h"
#include "frontend/error.h"
#include "frontend/folder_lock.h"
#include "frontend/output_file.h"
#include "frontend/parallel.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDescription = "description.yaml";

/// A folder of the experiment's own, or an empty one.
void open_folder(const fs::path& out) {
  std::error_code error;
  if (fs::exists(out, error) && !fs::is_directory(out, error)) throw InputError(out.string() + ": is no folder; choose another");
  if (fs::exists(out, error) && !fs::is_empty(out, error) && !fs::exists(out / "cells", error))
    throw InputError(out.string() + ": holds something else than an experiment; choose another folder");
  fs::create_directories(out / "cells", error);
  if (error) throw InputError(out.string() + ": cannot be created: " + error.message());
}

/// A folder that is gone with the object.
class ScratchFolder {
 public:
  explicit ScratchFolder(fs::path path) : path_(std::move(path)) {
    fs::remove_all(path_);
    std::error_code error;
    fs::create_directories(path_, error);
    if (error) throw InputError(path_.string() + ": cannot be created: " + error.message());
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// All finished cells; those that a killed run was at go when they are made again.
void remove_cells(const fs::path& folder) {
  std::vector<fs::path> cells;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".json" && entry.is_regular_file()) cells.push_back(entry.path());
  }
  for (const fs::path& cell : cells) {
    std::error_code error;
    fs::remove(cell, error);
    if (error) throw InputError(cell.string() + ": is of an earlier run and cannot be removed: " + error.message());
  }
}

std::size_t count_stale(const fs::path& folder, const std::vector<std::string>& checksums) {
  const std::set<std::string> known(checksums.begin(), checksums.end());
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(folder))
    count += entry.path().extension() == ".json" && !known.contains(entry.path().stem().string());
  return count;
}

void write_text(const fs::path& path, const std::string& text) {
  OutputFile file(path);
  file.stream() << text;
  file.commit();
}

/// What was told of cells that are to be made anew.
void remove_tables(const fs::path& out) {
  for (const char* name : {"results.csv", "results.json", "table.md"}) {
    std::error_code error;
    fs::remove(out / name, error);
    if (error) throw InputError((out / name).string() + ": is of an earlier run and cannot be removed: " + error.message());
  }
}

/// Pictures of an earlier description, which the present one may not write again.
void remove_figures(const fs::path& out) {
  std::vector<fs::path> figures;
  for (const auto& entry : fs::directory_iterator(out)) {
    const std::string name = entry.path().filename().string();
    const bool is_figure = name.starts_with("precision_recall_") || name.starts_with("false_share_");
    if (is_figure && name.ends_with(".png") && entry.is_regular_file()) figures.push_back(entry.path());
  }
  for (const fs::path& figure : figures) {
    std::error_code error;
    fs::remove(figure, error);
    if (error) throw InputError(figure.string() + ": is of an earlier run and cannot be removed: " + error.message());
  }
}

}  // namespace

LabRunReport run_lab(const LabDescription& description, const fs::path& out, const LabRunOptions& options) {
  const fs::path root = options.data_root.empty() ? description.path.parent_path() : options.data_root;
  std::vector<FinishedCell> cells;
  std::vector<std::string> checksums;
  for (LabCell& cell : cells_of(description, root)) {
    checksums.push_back(cell_checksum(cell, description));
    cells.push_back({std::move(cell), {}});
  }
  open_folder(out);
  const FolderLock lock(out);
  if (options.if_found == WorkState::IfFound::Discard) {
    remove_tables(out);
    remove_figures(out);
    remove_cells(out / "cells");
  }
  LabRunReport report;
  report.num_cells = cells.size();
  report.num_stale = count_stale(out / "cells", checksums);
  if (report.num_stale > 0 && options.warn) {
    options.warn((out / "cells").string() + ": " + std::to_string(report.num_stale) +
                 " cells are of another description, data or version, and have no part in the tables");
  }
  const int num_jobs = resolve_num_threads(options.num_jobs);
  const int threads_a_job = std::max(1, resolve_num_threads(options.num_threads) / num_jobs);
  std::mutex mutex;
  std::size_t num_done = 0;
  if (options.progress) options.progress("cells", num_done, cells.size());
  parallel_for(cells.size(), num_jobs, [&](std::size_t i) {
    const fs::path file = out / "cells" / (checksums[i] + ".json");
    std::optional<CellResult> known = read_cell(file, checksums[i]);
    const bool was_there = known.has_value();
    if (!was_there) {
      const ScratchFolder scratch(out / "cells" / (checksums[i] + ".scratch"));
      const CellResult made = run_cell(cells[i].cell, description, scratch.path(), threads_a_job);
      write_cell(file, checksums[i], cells[i].cell, made);
      known = read_cell(file, checksums[i]);
    }
    cells[i].result = std::move(*known);
    const std::scoped_lock guard(mutex);
    report.num_there += was_there;
    ++num_done;
    if (options.progress) options.progress("cells", num_done, cells.size());
  });
  const LabResults results = evaluate_cells(cells, description, num_jobs);
  write_results_csv(out / "results.csv", results, description);
  write_results_json(out / "results.json", results, description);
  write_text(out / "table.md", results_markdown(results, description));
  remove_figures(out);
  write_lab_figures(out, results, description);
  write_text(out / kDescription, description.text);
  return report;
}

}  // namespace fabloop
