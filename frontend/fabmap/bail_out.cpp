// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/bail_out.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "frontend/error.h"

namespace fabloop {
namespace {

/// (1 + u^2)^(1/2) - 1 - u asinh(u), negated: what grows with the lag in Bennett's bound.
double growth(double u) { return u * std::asinh(u) - std::sqrt(1.0 + u * u) + 1.0; }

double solve_by_newton(double wanted, double u) {
  constexpr int kMaxSteps = 50;
  constexpr double kPrecision = 1e-12;
  // growth() is convex, and at the start too small, so the first step goes too far and the others come back from there.
  for (int step = 0; step < kMaxSteps; ++step) {
    const double change = (growth(u) - wanted) / std::asinh(u);
    u -= change;
    if (std::abs(change) <= kPrecision * u) break;
  }
  return u;
}

double solve_by_bisection(double wanted, double low) {
  constexpr double kPrecision = 1e-12;
  double high = 2.0 * low;
  while (growth(high) < wanted) high *= 2.0;
  while (high - low > kPrecision * high) {
    const double middle = 0.5 * (low + high);
    (growth(middle) < wanted ? low : high) = middle;
  }
  return high;
}

/// The binomial distribution: p(k of n) for k = 0 ... n.
std::vector<double> binomial(std::uint32_t n, double p) {
  std::vector<double> result(n + 1, 0.0);
  if (p == 0.0) {
    result[0] = 1.0;
    return result;
  }
  double log_choose = 0.0;
  for (std::uint32_t k = 0; k <= n; ++k) {
    result[k] = std::exp(log_choose + k * std::log(p) + (n - k) * std::log1p(-p));
    log_choose += std::log(static_cast<double>(n - k) / static_cast<double>(k + 1));
  }
  return result;
}

/// What a word adds to a place of which nothing is known but how often it was visited.
struct Moments {
  double mean = 0.0;
  double variance = 0.0;
  double range = 0.0;
};

class WordMoments {
 public:
  WordMoments(const WordTerms& terms, std::uint32_t visits) : terms_(terms) {
    p_if_present_ = binomial(visits, terms.detector().p_seen_if_present);
    p_if_absent_ = binomial(visits, terms.detector().p_seen_if_absent);
    for (std::uint32_t k = 0; k <= visits; ++k) counts_.push_back(counts_of(terms.detector(), visits, k));
  }

  Moments operator()(const AffectedWord& word) const {
    constexpr double kNegligible = 1e-30;
    const double p_present = terms_.p_present_anywhere(word.word);
    Moments result;
    double mean_square = 0.0;
    // Never seen adds nothing; the more often seen the more, so that the last is the extreme.
    for (std::size_t k = 1; k < counts_.size(); ++k) {
      const double p = p_present * p_if_present_[k] + (1.0 - p_present) * p_if_absent_[k];
      if (p < kNegligible) continue;
      const double change = terms_.change_of_gain(word, counts_[k]);
      result.mean += p * change;
      mean_square += p * change * change;
    }
    result.variance = std::max(0.0, mean_square - result.mean * result.mean);
    result.range = std::abs(terms_.change_of_gain(word, counts_.back()));
    return result;
  }

 private:
  const WordTerms& terms_;
  std::vector<double> p_if_present_, p_if_absent_;  ///< By detections.
  std::vector<Counts> counts_;                      ///< By detections.
};

/// What the words from each position on would add.
struct Remainder {
  std::vector<std::vector<double>> mean;  ///< By number of visits (empty where it does not occur), then by position.
  std::vector<double> variance;           ///< By position: the largest of all numbers of visits.
  std::vector<double> range;              ///< Likewise, between two places, of one word.
};

Remainder remainder_of(const WordTerms& terms, const InvertedIndex::Query& query) {
  const std::size_t num_words = query.words.size();
  Remainder rest{{}, std::vector<double>(num_words + 1, 0.0), std::vector<double>(num_words + 1, 0.0)};
  // Two places visited equally often expect the same, so their difference is at most the range; others may expect the opposite.
  const double ends = query.where_never_seen.size() > 1 ? 2.0 : 1.0;
  for (const auto& [visits, where_never_seen] : query.where_never_seen) {
    if (rest.mean.size() <= visits) rest.mean.resize(visits + 1);
    std::vector<double>& mean = rest.mean[visits];
    mean.assign(num_words + 1, 0.0);
    const WordMoments moments(terms, visits);
    double variance = 0.0, range = 0.0;
    for (std::size_t i = num_words; i-- > 0;) {
      const Moments word = moments(query.words[i]);
      mean[i] = mean[i + 1] + word.mean;
      rest.variance[i] = std::max(rest.variance[i], variance += word.variance);
      rest.range[i] = std::max(rest.range[i], range = std::max(range, ends * word.range));
    }
  }
  return rest;
}

/// Those that tell places apart best come first.
void sort_by_variance(const WordTerms& terms, InvertedIndex::Query& query) {
  const WordMoments moments(terms, 1);
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < query.words.size(); ++i) order.emplace_back(-moments(query.words[i]).variance, i);
  std::sort(order.begin(), order.end());
  std::vector<AffectedWord> words;
  std::vector<double> change_once;
  for (const auto& [variance, i] : order) {
    words.push_back(query.words[i]);
    change_once.push_back(query.change_once[i]);
  }
  query.words = std::move(words);
  query.change_once = std::move(change_once);
}

/// Adds the words from `first` on to the places that are left.
void finish(const WordTerms& terms, const PlaceStore& places, const InvertedIndex::Query& query, std::size_t first,
            const std::vector<PlaceId>& kept, std::vector<double>& result) {
  std::vector<std::size_t> position(terms.num_words(), 0);  // of the word in the query, counted from one
  for (std::size_t i = first; i < query.words.size(); ++i) position[query.words[i].word] = i + 1;
  for (const PlaceId place : kept) {
    const std::uint32_t visits = places.visits(place);
    places.for_each_word(place, [&](WordId word, std::uint32_t detections) {
      if (position[word] == 0) return;
      const std::size_t i = position[word] - 1;
      result[place] += visits == 1 ? query.change_once[i]
                                   : terms.change_of_gain(query.words[i], counts_of(terms.detector(), visits, detections));
    });
  }
}

}  // namespace

void validate(const BailOutOptions& options) {
  const auto is_probability = [](double p) { return p > 0.0 && p < 1.0; };
  if (is_probability(options.p_drop_best) && is_probability(options.negligible) && options.check_every > 0) return;
  throw InputError("bail-out needs p_drop_best and negligible between 0 and 1, and check_every of at least 1");
}

double log_bennett_bound(double variance, double max_term, double lag) {
  return -variance / (max_term * max_term) * growth(lag * max_term / variance);
}

double bennett_lag(double variance, double max_term, double log_p, BennettSolver solver) {
  if (!(variance > 0.0 && max_term > 0.0)) return 0.0;
  const double wanted = -log_p * max_term * max_term / variance;
  const double start = std::sqrt(2.0 * wanted);  // growth(u) <= u^2 / 2
  const double u = solver == BennettSolver::Newton ? solve_by_newton(wanted, start) : solve_by_bisection(wanted, start);
  return u * variance / max_term;
}

BailOutResult log_likelihoods_with_bail_out(const WordTerms& terms, const VisitCounts& counts, const PlaceStore& places,
                                            const InvertedIndex& index, const Observation& observation,
                                            const BailOutOptions& options) {
  InvertedIndex::Query query = index.prepare(terms, counts, observation);
  sort_by_variance(terms, query);
  const Remainder rest = remainder_of(terms, query);
  BailOutResult result{index.start(query), {}};
  std::vector<double>& sum = result.log_likelihood;
  std::vector<PlaceId> kept(sum.size());
  for (PlaceId place = 0; place < kept.size(); ++place) kept[place] = place;

  const std::size_t num_words = query.words.size();
  const double margin = std::log(static_cast<double>(std::max<std::size_t>(1, sum.size())) / options.negligible);
  std::size_t done = 0;
  double lag = 0.0;
  const auto expected = [&](PlaceId place) { return sum[place] + rest.mean[places.visits(place)][done]; };
  // Finishing one place costs about as much as looking up one word in a map of a few thousand places.
  const std::size_t few = 1 + sum.size() / 256;
  while (done < num_words && kept.size() > few) {
    const std::size_t next = std::min(num_words, done + options.check_every);
    index.add_words(terms, counts, query, done, next, sum);
    done = next;
    // The lag is between two places, both of which the words to come may move.
    lag = bennett_lag(2.0 * rest.variance[done], rest.range[done], std::log(options.p_drop_best), options.solver);
    double best = expected(kept.front());
    for (const PlaceId place : kept) best = std::max(best, expected(place));
    std::erase_if(kept, [&](PlaceId place) { return expected(place) < best - lag - margin; });
  }
  if (done == num_words) return result;
  std::vector<double> bounds = sum;
  for (PlaceId place = 0; place < bounds.size(); ++place) bounds[place] = expected(place) + lag;
  finish(terms, places, query, done, kept, sum);
  for (PlaceId place = 0, next_kept = 0; place < sum.size(); ++place) {
    if (next_kept < kept.size() && kept[next_kept] == place) {
      ++next_kept;
    } else {
      sum[place] = bounds[place];
      result.dropped.push_back(place);
    }
  }
  return result;
}

}  // namespace fabloop
