// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/fabmap2_io.h"

#include <gmock/gmock.h>

#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kTree = "# word,parent,p,p1,p0\n0,-1,0.5,0.4,0.6\n1,0,0.25,0.75,0.875\n2,1,0.5,0.5,0.25\n";
constexpr const char* kImages = "# image,name,keypoints,words\n7,grab_1,10,2:1 0:3\n9,grab_2,5,1:2\n11,grab_3,0,\n";

class FabMap2Io : public ::testing::Test {
 protected:
  std::string error_of_tree(const std::string& text) const {
    return input_error_of([&] { read_fabmap2_tree(folder_.write("tree.csv", text)); });
  }
  std::string error_of_images(const std::string& text) const {
    return input_error_of([&] { read_fabmap2_images(folder_.write("bow.csv", text), 3); });
  }

  TemporaryFolder folder_;
};

TEST_F(FabMap2Io, TurnsTheLastColumnRound) {
  const ChowLiuTree tree = read_fabmap2_tree(folder_.write("tree.csv", kTree));
  ASSERT_EQ(tree.num_words(), 3u);
  EXPECT_EQ(tree.nodes[0].parent, std::nullopt);
  EXPECT_EQ(tree.nodes[0].p_if_parent, 0.5) << "a root's conditionals are its marginal";
  EXPECT_EQ(tree.nodes[1].parent, 0u);
  EXPECT_EQ(tree.nodes[1].p_if_parent, 0.75);
  EXPECT_EQ(tree.nodes[1].p_if_no_parent, 0.125);
}

TEST_F(FabMap2Io, ReadsImagesWithSortedWordsAndPairs) {
  folder_.write("chow_liu_tree.csv", kTree);
  folder_.write("bow.csv", kImages);
  folder_.write("gt_pairs.csv", "# query,match\r\n9,7\r\n");
  const FabMap2Model model = read_fabmap2(folder_.path());
  EXPECT_THAT(model.observations.at(7).words, ElementsAre(0, 2));
  EXPECT_THAT(model.observations.at(11).words, ElementsAre());
  EXPECT_THAT(model.true_pairs, ElementsAre(std::pair(9, 7)));
  folder_.write("gt_pairs.csv", "9,8\n");
  EXPECT_THAT(input_error_of([&] { read_fabmap2(folder_.path()); }), HasSubstr("gt_pairs.csv:1: image 8 is not in bow.csv"));
}

TEST_F(FabMap2Io, NamesTheLineOfABadTree) {
  EXPECT_THAT(error_of_tree("0,-1,0.5,0.4,0.6\n2,0,0.5,0.5,0.5\n"), HasSubstr("tree.csv:2: word 2 where word 1 is due"));
  EXPECT_THAT(error_of_tree("0,-1,0.5,0.4\n"), HasSubstr("tree.csv:1: expected"));
  EXPECT_THAT(error_of_tree("0,-1,0.5,0.4,0.6,0.1\n"), HasSubstr("tree.csv:1: there is more"));
  EXPECT_THAT(error_of_tree("0,-1,1,0.4,0.6\n"), HasSubstr("tree.csv:1: a probability"));
  EXPECT_THAT(error_of_tree("0,-1,nan,0.4,0.6\n"), HasSubstr("tree.csv:1: "));
  EXPECT_THAT(error_of_tree("0,-2,0.5,0.4,0.6\n"), HasSubstr("tree.csv:1: parent -2"));
  EXPECT_THAT(error_of_tree("0,3,0.5,0.4,0.6\n"), HasSubstr("word 0 has parent 3"));
  EXPECT_THAT(error_of_tree("0,1,0.5,0.4,0.6\n1,0,0.5,0.4,0.6\n"), HasSubstr("circle"));
  EXPECT_THAT(error_of_tree(""), HasSubstr("no words"));
  EXPECT_THAT(input_error_of([&] { read_fabmap2_tree(folder_.path()); }), HasSubstr("cannot be read"));
}

TEST_F(FabMap2Io, NamesTheLineOfABadImage) {
  EXPECT_THAT(error_of_images("7,a,1,0:1\n8,b,1,3:1\n"), HasSubstr("bow.csv:2: word 3 but there are only 3 words"));
  EXPECT_THAT(error_of_images("7,a,1,0:1\n7,b,1,1:1\n"), HasSubstr("bow.csv:2: image 7 comes twice"));
  EXPECT_THAT(error_of_images("7,a,1,0\n"), HasSubstr("bow.csv:1: \"0\" is not word:count"));
  EXPECT_THAT(error_of_images("7,a,1,0:1 0:2\n"), HasSubstr("bow.csv:1: a word comes twice"));
  EXPECT_THAT(error_of_images("seven,a,1,0:1\n"), HasSubstr("bow.csv:1: expected"));
}

}  // namespace
}  // namespace fabloop
