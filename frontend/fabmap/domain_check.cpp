// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/domain_check.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>
#include <utility>

#include "frontend/error.h"

namespace fabloop {
namespace {

constexpr std::size_t kNumQuantiles = 101;
/// The least of fewer images says too little: 8 of 37 gave false alarms on the other half of their own flight.
constexpr std::size_t kMinImages = 12;

/// Between the two nearest of `sorted`, in proportion.
double quantile(const std::vector<double>& sorted, double share) {
  const double position = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

std::vector<double> frequencies(const ChowLiuTree& tree) {
  std::vector<double> result;
  for (const ChowLiuNode& node : tree.nodes) result.push_back(node.p);
  return result;
}

/// 0, 1, ..., 100 %.
std::vector<double> quantiles(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  std::vector<double> result;
  for (std::size_t i = 0; i < kNumQuantiles; ++i) {
    result.push_back(quantile(values, static_cast<double>(i) / (kNumQuantiles - 1)));
  }
  return result;
}

double log_likelihood_per_word(const TreeLikelihood& likelihood, const Observation& observation) {
  return likelihood(observation) / static_cast<double>(observation.words.size());
}

void require_quantiles(const std::vector<double>& values) {
  if (values.size() != kNumQuantiles || !std::is_sorted(values.begin(), values.end())) {
    throw InputError("a domain whose quantiles are in no order");
  }
}

}  // namespace

Familiarity::Familiarity(const std::vector<double>& frequency) : rank_(frequency.size()) {
  std::vector<std::size_t> order(frequency.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return frequency[a] < frequency[b]; });
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    while (end < order.size() && frequency[order[end]] == frequency[order[begin]]) ++end;
    const double rank = 0.5 * static_cast<double>(begin + 1 + end);
    for (; begin < end; ++begin) rank_[order[begin]] = rank;
  }
}

double Familiarity::operator()(const Observation& observation) const {
  const auto seen = static_cast<double>(observation.words.size());
  const double unseen = static_cast<double>(rank_.size()) - seen;
  if (seen == 0.0 || unseen == 0.0) return 0.5;
  double sum = 0.0;
  for (const WordId word : observation.words) sum += rank_[word];
  return (sum - seen * (seen + 1.0) / 2.0) / (seen * unseen);
}

std::optional<Domain> measure_domain(const HeldOut& held_out) {
  const Familiarity familiarity(frequencies(held_out.tree));
  const TreeLikelihood likelihood(held_out.tree);
  std::vector<double> familiar, likely;
  for (const Observation& image : held_out.images) {
    if (image.words.empty()) continue;
    familiar.push_back(familiarity(image));
    likely.push_back(log_likelihood_per_word(likelihood, image));
  }
  if (familiar.size() < kMinImages) return std::nullopt;
  return Domain{quantiles(std::move(familiar)), quantiles(std::move(likely))};
}

DomainCheck::DomainCheck(const Model& model, DomainCheckOptions options)
    : options_(std::move(options)), domain_(model.domain), familiarity_(frequencies(model.tree)), likelihood_(model.tree) {}

bool DomainCheck::is_unlike_training(const Observation& observation) const {
  return familiarity_(observation) < quantile(domain_->familiarity, options_.quantile) ||
         log_likelihood_per_word(likelihood_, observation) < quantile(domain_->log_likelihood_per_word, options_.quantile);
}

void DomainCheck::add(const Observation& observation) {
  if (!domain_ || observation.words.empty()) return;
  recent_.push_back(is_unlike_training(observation));
  if (recent_.size() > options_.window) recent_.pop_front();
  if (is_unlike_ || recent_.size() < options_.window) return;
  const auto num_unlike = std::count(recent_.begin(), recent_.end(), true);
  if (static_cast<double>(num_unlike) <= options_.max_unlike * static_cast<double>(recent_.size())) return;
  is_unlike_ = true;
  if (!options_.warn) return;
  std::ostringstream text;
  text << "the images look unlike those that the model was trained on (" << num_unlike << " of the last " << recent_.size()
       << " show words that are rarer, or go together less, than in " << 100.0 * (1.0 - options_.quantile)
       << " % of those); probabilities mean little then: train a model on images of this kind of place";
  options_.warn(text.str());
}

std::string to_json(const Domain& domain) {
  return nlohmann::json{{"familiarity_quantiles", domain.familiarity},
                        {"log_likelihood_per_word_quantiles", domain.log_likelihood_per_word}}
      .dump();
}

Domain domain_from_json(const std::string& text) {
  Domain domain;
  try {
    const auto json = nlohmann::json::parse(text);
    json.at("familiarity_quantiles").get_to(domain.familiarity);
    json.at("log_likelihood_per_word_quantiles").get_to(domain.log_likelihood_per_word);
  } catch (const nlohmann::json::exception&) {
    throw InputError("a domain that cannot be understood");
  }
  require_quantiles(domain.familiarity);
  require_quantiles(domain.log_likelihood_per_word);
  return domain;
}

}  // namespace fabloop
