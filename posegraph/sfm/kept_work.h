// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "frontend/fabmap/model.h"
#include "frontend/state_bytes.h"
#include "frontend/work_state.h"
#include "posegraph/sfm/colour_views.h"
#include "posegraph/sfm/growth.h"
#include "posegraph/sfm/reconstruct.h"

/// What a reconstruction keeps of its finished work (private): how it lies in the files of its state, and what it depends on.
namespace fabloop {

/// Names of files in the state; those of views and pairs are numbered.
inline constexpr const char* kKeptView = "view";
inline constexpr const char* kKeptFrames = "frames";
inline constexpr const char* kKeptCandidates = "candidates";
inline constexpr const char* kKeptPairs = "pairs";
inline constexpr const char* kKeptSegments = "segments";

StateBytes bytes_of(const ColourView& view);
ColourView take_colour_view(StateBytes& bytes, std::size_t frame, const Camera& camera);

/// Notes which frames the views are of. Later stages count views: where a former run saw others (a file could not be read then,
/// or cannot be now), what it kept of them is removed.
void keep_frames(const std::vector<View>& views, WorkState& state);

StateBytes bytes_of(const std::vector<CandidatePair>& candidates);
std::vector<CandidatePair> take_candidates(StateBytes& bytes);

/// One entry a candidate: proven or not.
StateBytes bytes_of(const std::vector<std::optional<ViewPair>>& pairs);
std::vector<std::optional<ViewPair>> take_pairs(StateBytes& bytes);

StateBytes bytes_of(const SegmentsSoFar& segments);
SegmentsSoFar take_segments(StateBytes& bytes);

/// Names everything that the kept work depends on, one thing a line: the images (name, size, time), the camera, the model and the
/// options of all stages up to the placed segments. What comes after them is done anew.
std::string inputs_text(const Sequence& sequence, const std::optional<Model>& model, const ReconstructOptions& options);

/// The state of `options.state_folder`, told where a former run stopped; one that keeps nothing where there is no folder.
WorkState open_state(const Sequence& sequence, const std::optional<Model>& model, const ReconstructOptions& options);

}  // namespace fabloop
