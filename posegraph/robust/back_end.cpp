// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/robust/back_end.h"

#include <array>

#include "frontend/names.h"

namespace fabloop {
namespace {

constexpr std::array<Named<BackEnd>, 9> kBackEnds{{{BackEnd::None, "none"},
                                                   {BackEnd::Huber, "huber"},
                                                   {BackEnd::Cauchy, "cauchy"},
                                                   {BackEnd::GemanMcClure, "geman-mcclure"},
                                                   {BackEnd::DynamicCovarianceScaling, "dcs"},
                                                   {BackEnd::SwitchableConstraints, "switchable"},
                                                   {BackEnd::GncTruncated, "gnc-truncated"},
                                                   {BackEnd::GncGemanMcClure, "gnc-geman-mcclure"},
                                                   {BackEnd::PairwiseConsistency, "pairwise-consistency"}}};

}  // namespace

std::string_view to_string(BackEnd back_end) { return name_of(kBackEnds, back_end); }

std::optional<BackEnd> back_end_named(std::string_view name) { return named(kBackEnds, name); }

std::vector<BackEnd> all_back_ends() {
  std::vector<BackEnd> result;
  for (const auto& entry : kBackEnds) result.push_back(entry.value);
  return result;
}

}  // namespace fabloop
