// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/model_hash.h"

#include <cstdint>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string_view>

#include "frontend/checksum.h"
#include "frontend/features/feature_settings.h"
#include "frontend/state_bytes.h"

namespace fabloop {

std::string model_hash(const Model& model) {
  StateBytes content;
  const cv::Mat& words = model.vocabulary.words;
  content.put(static_cast<std::int32_t>(words.rows));
  content.put(static_cast<std::int32_t>(words.cols));
  content.put(checksum({words.ptr<char>(), words.total() * words.elemSize()}));
  content.put(checksum(feature_options_json(model.features)));
  content.put(model.detector.p_seen_if_present);
  content.put(model.detector.p_seen_if_absent);
  for (const ChowLiuNode& node : model.tree.nodes) {
    content.put(node.parent.value_or(std::numeric_limits<WordId>::max()));
    content.put(node.p);
    content.put(node.p_if_parent);
    content.put(node.p_if_no_parent);
  }
  std::ostringstream text;
  text << std::hex << std::setw(16) << std::setfill('0') << checksum(content.bytes());
  return text.str();
}

}  // namespace fabloop
