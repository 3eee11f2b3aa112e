// SPDX-License-Identifier: BSD-3-Clause
#include "verification/verdict.h"

namespace fabloop {

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::Accepted:
      return "Accepted";
    case Verdict::TooFewMatches:
      return "TooFewMatches";
    case Verdict::NoPose:
      return "NoPose";
    case Verdict::TooFewInliers:
      return "TooFewInliers";
    case Verdict::AccidentalInliers:
      return "AccidentalInliers";
    case Verdict::InliersInCorner:
      return "InliersInCorner";
    case Verdict::RepeatedTexture:
      return "RepeatedTexture";
    case Verdict::NoParallax:
      return "NoParallax";
    case Verdict::AmbiguousPose:
      return "AmbiguousPose";
    case Verdict::ScaleDisagrees:
      return "ScaleDisagrees";
    case Verdict::PoorlyConstrained:
      return "PoorlyConstrained";
    case Verdict::Improbable:
      return "Improbable";
    case Verdict::Unconfirmed:
      return "Unconfirmed";
    case Verdict::ContradictsMap:
      return "ContradictsMap";
  }
  return "";
}

}  // namespace fabloop
