// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>

#include "frontend/fabmap/model.h"
#include "frontend/fabmap/precision_recall.h"
#include "frontend/npy.h"
#include "frontend/output_file.h"
#include "frontend/recognition/observed_images.h"
#include "frontend/recognition/recognition_run.h"
#include "frontend/recognition/row_spool.h"

namespace fabloop {

/// What was recognised, with what, and how well. Keeps references: for the length of a call.
struct RecognitionReport {
  const Model& model;
  const RecognitionOptions& options;
  const ObservedImages& queries;
  const ObservedImages* map = nullptr;  ///< None: the sequence was recognised in itself.
  const Recognition& recognition;
  const GroundTruth* truth = nullptr;       ///< None: nothing to judge by.
  const PrecisionRecall* judged = nullptr;  ///< With `truth`.
};

/// The folder that a run of place recognition writes; it appears when it is complete. Its files are described in the folder's
/// README. The matrices pass through files in it, so that they need not stand in memory.
class RecognitionFolder {
 public:
  /// `matrix_type` is Float32 or Float64. Throws InputError as OutputFolder does.
  RecognitionFolder(const std::filesystem::path& path, OutputFolder::IfExists if_exists, NpyType matrix_type = NpyType::Float32);

  /// To be given as RecognitionOptions::on_row.
  BeliefRow on_row();

  /// Writes all files and lets the folder appear. Once.
  void finish(const RecognitionReport& report);

 private:
  void write_matrices(const RecognitionReport& report);

  OutputFolder folder_;
  NpyType matrix_type_;
  std::optional<RowSpool> p_place_;
  std::optional<RowSpool> log_likelihood_;
};

}  // namespace fabloop
