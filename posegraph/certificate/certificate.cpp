// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/certificate/certificate.h"

#include <algorithm>
#include <optional>
#include <sstream>
#include <string>

#include "frontend/error.h"
#include "posegraph/certificate/certificate_matrix.h"
#include "posegraph/certificate/connection_laplacian.h"
#include "posegraph/connectivity.h"

namespace fabloop {
namespace {

void check_certifiable(const PoseGraph& graph) {
  check(graph);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    if (graph.edges[e].has_scale) continue;
    throw InputError("certificate: edge " + std::to_string(e) +
                     " (counted from 0) has no scale, so the cost is no quadratic form");
  }
  if (!graph.priors.empty()) throw InputError("certificate: there is none for graphs with priors; remove them");
  const Components components = connected_components(graph);
  if (find_anchors(graph, components).size() > components.count) {
    throw InputError("certificate: two fixed vertices hang together, so more than the edges decides; fix one at most");
  }
}

}  // namespace

Certificate certify(const PoseGraph& graph, const CertificateOptions& options) {
  check_certifiable(graph);
  Certificate certificate;
  if (graph.edges.empty()) {
    certificate.is_global = true;
    return certificate;
  }
  CertificateMatrix matrix(graph, stacked_poses(graph));
  certificate.cost = matrix.cost();
  const double shift = matrix.shift_of(options.max_relative_gap);
  certificate.is_global = matrix.is_positive_definite(shift);
  const std::optional<CertificateMatrix::Eigenpair> smallest = matrix.smallest_eigenpair(shift);
  if (smallest) certificate.smallest_eigenvalue = smallest->value;
  // The factorisation proves the bound; Lanczos says where above it the truth is.
  if (certificate.is_global || smallest) {
    const double proved_shift = certificate.is_global ? shift : smallest->proved_shift;
    certificate.lower_bound = std::max(0.0, certificate.cost - static_cast<double>(matrix.size()) * proved_shift);
  }
  return certificate;
}

double Certificate::relative_gap() const { return cost > 0.0 ? (cost - lower_bound) / cost : 0.0; }

std::string Certificate::brief() const {
  std::ostringstream text;
  text.precision(10);
  text << (is_global ? "the global optimum" : "not certified") << ": cost " << cost << ", no poses below " << lower_bound;
  text.precision(3);
  text << " (gap " << relative_gap() << "), smallest eigenvalue " << smallest_eigenvalue;
  return text.str();
}

}  // namespace fabloop
