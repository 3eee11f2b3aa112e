// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/domain_check.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "frontend/error.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

using fabloop::testing_support::random_tree;
using fabloop::testing_support::TreeSampler;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Independent words, each seen more often than the one before.
ChowLiuTree ascending_words() {
  ChowLiuTree tree;
  for (int i = 0; i < 300; ++i) {
    const double p = 0.02 + 0.001 * i;
    tree.nodes.push_back({std::nullopt, p, p, p});
  }
  return tree;
}

/// A model that knows its training set.
Model trained_on(const ChowLiuTree& tree, const std::vector<Observation>& observations) {
  Model model;
  model.tree = tree;
  model.domain = measure_domain(hold_out(observations, tree.num_words()).value());
  return model;
}

TEST(Familiarity, IsTheShareOfWordPairsInOrder) {
  const Familiarity familiarity({3, 1, 2, 2});
  EXPECT_EQ(familiarity({{0}}), 1.0);
  EXPECT_EQ(familiarity({{1}}), 0.0);
  EXPECT_DOUBLE_EQ(familiarity({{2}}), 0.5) << "above 1, equal to 3, below 0";
  EXPECT_EQ(familiarity({{0, 2}}), 0.875) << "three of four pairs, and one half";
  EXPECT_EQ(familiarity({{}}), 0.5);
  EXPECT_EQ(familiarity({{0, 1, 2, 3}}), 0.5);
}

class DomainCheckTest : public ::testing::Test {
 protected:
  DomainCheckOptions options() {
    DomainCheckOptions options;
    options.warn = [this](const std::string& message) { warnings_.push_back(message); };
    return options;
  }

  const ChowLiuTree tree_ = ascending_words();
  const Model model_ = trained_on(tree_, TreeSampler(tree_, 1).draw(200));
  std::vector<std::string> warnings_;
};

TEST_F(DomainCheckTest, WarnsOnceWhereWordsHaveOtherFrequencies) {
  DomainCheck check(model_, options());
  ChowLiuTree other = tree_;  // as many words, but others
  std::reverse(other.nodes.begin(), other.nodes.end());
  TreeSampler sampler(other, 2);
  for (int i = 0; i < 19; ++i) check.add(sampler.draw());
  EXPECT_THAT(warnings_, IsEmpty()) << "the window is not full";
  for (int i = 0; i < 60; ++i) check.add(sampler.draw());
  EXPECT_TRUE(check.is_unlike());
  ASSERT_THAT(warnings_, SizeIs(1));
  EXPECT_THAT(warnings_[0], HasSubstr("20 of the last 20"));
}

TEST_F(DomainCheckTest, IsSilentOnImagesOfTheSameKind) {
  DomainCheck check(model_, options());
  TreeSampler sampler(tree_, 3);
  for (int i = 0; i < 500; ++i) check.add(sampler.draw());
  EXPECT_FALSE(check.is_unlike());
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(DomainCheckTest, ForgivesAFewStrangeImagesAndCountsNoneWithoutWords) {
  DomainCheck check(model_, options());
  TreeSampler sampler(tree_, 3);
  for (int i = 0; i < 100; ++i) {
    check.add(sampler.draw());
    check.add({});
    if (i % 3 == 0) check.add({{static_cast<WordId>(i)}});
  }
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(DomainCheckTest, ChecksNothingWithoutADomain) {
  Model model = model_;
  model.domain.reset();
  DomainCheck check(model, options());
  for (WordId i = 0; i < 60; ++i) check.add({{i}});
  EXPECT_FALSE(check.is_unlike());
}

TEST(Domain, ComesBackFromJsonAndRefusesDisorder) {
  const auto held_out = hold_out(TreeSampler(random_tree(50, 0.2, 1), 1).draw(80), 50);
  const Domain domain = measure_domain(held_out.value()).value();
  EXPECT_THAT(domain.familiarity, SizeIs(101));
  const Domain read = domain_from_json(to_json(domain));
  EXPECT_EQ(read.familiarity, domain.familiarity);
  EXPECT_EQ(read.log_likelihood_per_word, domain.log_likelihood_per_word);
  EXPECT_THROW(domain_from_json("{}"), InputError);
  Domain disorder = domain;
  std::swap(disorder.familiarity[3], disorder.familiarity[90]);
  EXPECT_THROW(domain_from_json(to_json(disorder)), InputError);
  disorder = domain;
  disorder.log_likelihood_per_word.pop_back();
  EXPECT_THROW(domain_from_json(to_json(disorder)), InputError);
}

TEST(Domain, NeedsEnoughImagesWithWords) {
  EXPECT_FALSE(measure_domain(hold_out(std::vector<Observation>(50, {{1}}), 3).value()));
  EXPECT_FALSE(hold_out(std::vector<Observation>(9), 3));
  EXPECT_FALSE(measure_domain(hold_out(std::vector<Observation>(100), 3).value()));
}

TEST(HeldOut, AreBlocksThatTheTreeDoesNotKnow) {
  // Word 0 is seen in the held-out images alone: blocks 2, 7, 12 and 17 of 20.
  std::vector<Observation> observations(40);
  for (std::size_t i = 0; i < observations.size(); ++i) observations[i].words = {i / 2 % 5 == 2 ? WordId{0} : WordId{1}};
  const HeldOut held_out = hold_out(observations, 2).value();
  EXPECT_THAT(held_out.images, SizeIs(8));
  for (const Observation& image : held_out.images) EXPECT_EQ(image.words, std::vector<WordId>{0});
  EXPECT_LT(held_out.tree.nodes[0].p, 0.03);
}

}  // namespace
}  // namespace fabloop
