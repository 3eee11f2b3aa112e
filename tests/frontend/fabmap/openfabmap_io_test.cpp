// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/fabmap/openfabmap_io.h"

#include <gmock/gmock.h>

#include <limits>

#include "tests/frontend/sequence/temporary_folder.h"
#include "tests/support/descriptor_sampling.h"
#include "tests/support/tree_sampling.h"

namespace fabloop {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Four words as openFABMAP writes them (cv::FileStorage of OpenCV 2.4): word 2 is the root and its own parent.
constexpr const char* kOpenFabmapTree = R"(%YAML:1.0
ChowLiuTree: !!opencv-matrix
   rows: 4
   cols: 4
   dt: d
   data: [ 2., 0., 2., 2., 5.0000000000000000e-01, 2.5500000000000000e-01,
       7.4500000000000000e-01, 1.0000000000000001e-02, 6.0000000000000000e-01,
       9.8999999999999999e-01, 7.4500000000000000e-01, 2.0000000000000000e-02,
       2.5000000000000000e-01, 1.0000000000000001e-02, 7.4500000000000000e-01,
       1.0000000000000001e-02 ]
)";

std::string matrix(const std::string& name, int rows, int cols, const std::string& type, const std::string& data) {
  return "%YAML:1.0\n" + name + ": !!opencv-matrix\n   rows: " + std::to_string(rows) + "\n   cols: " + std::to_string(cols) +
         "\n   dt: " + type + "\n   data: [ " + data + " ]\n";
}

class OpenFabMapIo : public ::testing::Test {
 protected:
  std::string error_of_tree(const std::string& text) const {
    return input_error_of([&] { read_openfabmap_tree(folder_.write("tree.yml", text)); });
  }
  ChowLiuTree tree_of(const std::string& data, int num_words) {
    return read_openfabmap_tree(folder_.write("tree.yml", matrix("ChowLiuTree", 4, num_words, "d", data)),
                                [&](const std::string& message) { warnings_.push_back(message); });
  }

  TemporaryFolder folder_;
  std::vector<std::string> warnings_;
};

TEST_F(OpenFabMapIo, ReadsATreeWhoseRootIsItsOwnParent) {
  const ChowLiuTree tree = read_openfabmap_tree(folder_.write("tree.yml", kOpenFabmapTree));
  ASSERT_EQ(tree.num_words(), 4u);
  EXPECT_EQ(tree.nodes[2].parent, std::nullopt);
  EXPECT_EQ(tree.nodes[0].parent, 2u);
  EXPECT_EQ(tree.nodes[1].parent, 0u);
  EXPECT_EQ(tree.nodes[1].p, 0.255);
  EXPECT_EQ(tree.nodes[1].p_if_parent, 0.99);
  EXPECT_EQ(tree.nodes[1].p_if_no_parent, 0.01);
}

TEST_F(OpenFabMapIo, MovesProbabilitiesInsideAndSaysHowMany) {
  const ChowLiuTree tree = tree_of("0., 0., 1., 1., 0.5, 0.25, 1., 0., 0.5, .Nan, 1., 0., 0.5, 0.25, 0.5, 1.", 4);
  EXPECT_NO_THROW(validate(tree, "tree"));
  EXPECT_EQ(tree.nodes[1].p_if_parent, 0.25) << "of a parent never seen, nothing is known";
  EXPECT_EQ(tree.nodes[2].p, 1.0 - 1e-4);
  EXPECT_EQ(tree.nodes[3].p_if_no_parent, 1.0 - 1e-4);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_THAT(warnings_[0], HasSubstr("tree.yml: 5 probabilities of 0 or 1"));
  EXPECT_THAT(warnings_[0], HasSubstr("1 that are not numbers"));
}

TEST_F(OpenFabMapIo, TakesHubsForestsAndOneWord) {
  EXPECT_EQ(tree_of("0., 0., 0., 3., 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5", 4).nodes[3].parent,
            std::nullopt);
  EXPECT_EQ(tree_of("-1., 0.5, 0.5, 0.5", 1).nodes[0].parent, std::nullopt);
  EXPECT_TRUE(warnings_.empty());
}

TEST_F(OpenFabMapIo, RefusesWhatIsNoTree) {
  const auto tree = [](const std::string& data) { return matrix("ChowLiuTree", 4, 2, "d", data); };
  EXPECT_THAT(error_of_tree(tree("1., 0., 0.5, 0.5, 0.5, 0.5, 0.5, 0.5")), HasSubstr("circle"));
  EXPECT_THAT(error_of_tree(tree("0., 2., 0.5, 0.5, 0.5, 0.5, 0.5, 0.5")), HasSubstr("word 1 has parent 2"));
  EXPECT_THAT(error_of_tree(tree("0., 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5")), HasSubstr("word 1 has parent 0.5"));
  EXPECT_THAT(error_of_tree(tree("0., .Nan, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5")), HasSubstr("word 1 has parent"));
  EXPECT_THAT(error_of_tree(tree("0., 0., 0.5, 1.5, 0.5, 0.5, 0.5, 0.5")), HasSubstr("word 1 has probability 1.5"));
  EXPECT_THAT(error_of_tree(tree("0., 0., 0.5, .Nan, 0.5, 0.5, 0.5, 0.5")), HasSubstr("word 1 has probability"));
  EXPECT_THAT(error_of_tree(tree("0., 0., 0.5, 0.5, 0.5, 0.5, 0.5")), HasSubstr("has 7 numbers; is the file truncated?"));
  EXPECT_THAT(error_of_tree(matrix("ChowLiuTree", 2, 4, "d", "0., 0., 0., 0., 0., 0., 0., 0.")), HasSubstr("transposed"));
  EXPECT_THAT(error_of_tree(matrix("ChowLiuTree", 4, 1, "u", "0, 1, 1, 1")), HasSubstr("type \"u\""));
  EXPECT_THAT(error_of_tree(matrix("ChowLiuTree", 2000000000, 2000000000, "d", "0.")), HasSubstr("truncated"));
  EXPECT_THAT(error_of_tree(matrix("Vocabulary", 1, 1, "f", "0.")), HasSubstr("no matrix named ChowLiuTree"));
}

TEST_F(OpenFabMapIo, RefusesFilesThatAreNotFileStorage) {
  EXPECT_THAT(error_of_tree(""), HasSubstr("is empty"));
  EXPECT_THAT(error_of_tree("these are not the words"), HasSubstr("FileStorage"));
  EXPECT_THAT(error_of_tree(std::string("\x1f\x8b\x08\x00 no gzip", 12)), HasSubstr("tree.yml"));
  EXPECT_THAT(error_of_tree("%YAML:1.0\nChowLiuTree: [ 1, 2 ]\n"), HasSubstr("no matrix named"));
  EXPECT_THAT(input_error_of([&] { read_openfabmap_tree(folder_.path() / "missing.yml"); }), HasSubstr("missing.yml"));
  EXPECT_THAT(input_error_of([&] { read_openfabmap_tree(folder_.path()); }), HasSubstr(folder_.path().string()));
}

TEST_F(OpenFabMapIo, IsRefusedOrReadWhenTruncatedAnywhere) {
  const std::string text = kOpenFabmapTree;
  for (std::size_t size = 0; size + 4 < text.size(); size += 7) {
    EXPECT_THROW(read_openfabmap_tree(folder_.write("tree.yml", text.substr(0, size))), InputError) << size;
  }
}

TEST_F(OpenFabMapIo, ReadsWordsThatWereSeenAndRefusesWhatIsNotFinite) {
  const OpenFabMapImages images =
      read_openfabmap_images(folder_.write("bow.yml", matrix("BOWImageDescs", 2, 3, "f", "0., 2.5e-01, 7.5e-01, 0., 0., 0.")));
  EXPECT_EQ(images.num_words, 3u);
  EXPECT_THAT(images.observations[0].words, ElementsAre(1, 2));
  EXPECT_THAT(images.observations[1].words, ElementsAre());
  const fs::path bad = folder_.write("vocabulary.yml", matrix("Vocabulary", 1, 2, "f", "0., .Inf"));
  EXPECT_THAT(input_error_of([&] { read_openfabmap_vocabulary(bad); }), HasSubstr("vocabulary.yml: Vocabulary has entries"));
}

TEST_F(OpenFabMapIo, TellsFilesApart) {
  EXPECT_EQ(openfabmap_file_kind(folder_.write("a.yml", kOpenFabmapTree)), OpenFabMapFile::ChowLiuTree);
  EXPECT_EQ(openfabmap_file_kind(folder_.write("b.yml", matrix("Vocabulary", 1, 1, "f", "0."))), OpenFabMapFile::Vocabulary);
  EXPECT_EQ(openfabmap_file_kind(folder_.write("c.yml", matrix("BOWImageDescs", 1, 1, "f", "0."))), OpenFabMapFile::BowImages);
  EXPECT_EQ(openfabmap_file_kind(folder_.write("d.yml", "%YAML:1.0\nopenFabMapOptions:\n   PzGe: 0.4\n")),
            OpenFabMapFile::Settings);
  EXPECT_THAT(input_error_of([&] { openfabmap_file_kind(folder_.write("e.yml", "%YAML:1.0\nother: 1\n")); }),
              HasSubstr("none of"));
}

Model some_sift_model() {
  Model model;
  model.features.root_sift = false;
  model.features.clahe_clip_limit.reset();
  model.tree = fabloop::testing_support::random_tree(30, 0.2, 1);
  model.vocabulary.words = fabloop::testing_support::clustered_descriptors(30, 128, 30, 1);
  model.background = fabloop::testing_support::TreeSampler(model.tree, 1).draw(5);
  model.background.push_back({});
  model.detector = {0.5, 0.01};
  return model;
}

/// Writes a model and reads it again.
Model there_and_back(const Model& model, const fs::path& folder, OpenFabMapWriteOptions::Compression compression) {
  OpenFabMapWriteOptions options;
  options.compression = compression;
  write_openfabmap_model(folder, model, options);
  const std::string extension = compression == OpenFabMapWriteOptions::Compression::Gzip ? ".yml.gz" : ".yml";
  OpenFabMapReadOptions read_options;
  read_options.features = model.features;
  return read_openfabmap_model({folder / ("vocabulary" + extension), folder / ("tree" + extension), folder / ("bow" + extension)},
                               read_options);
}

TEST_F(OpenFabMapIo, GivesAModelBackBitByBit) {
  const Model model = some_sift_model();
  for (const auto compression : {OpenFabMapWriteOptions::Compression::None, OpenFabMapWriteOptions::Compression::Gzip}) {
    const Model read = there_and_back(model, folder_.path() / std::to_string(static_cast<int>(compression)), compression);
    EXPECT_EQ(cv::norm(read.vocabulary.words, model.vocabulary.words, cv::NORM_INF), 0.0);
    ASSERT_EQ(read.background.size(), model.background.size());
    for (std::size_t i = 0; i < read.background.size(); ++i) EXPECT_EQ(read.background[i].words, model.background[i].words);
    for (WordId word = 0; word < model.tree.num_words(); ++word) {
      EXPECT_EQ(read.tree.nodes[word].parent, model.tree.nodes[word].parent);
      EXPECT_EQ(read.tree.nodes[word].p, model.tree.nodes[word].p);
      EXPECT_EQ(read.tree.nodes[word].p_if_parent, model.tree.nodes[word].p_if_parent);
      EXPECT_EQ(read.tree.nodes[word].p_if_no_parent, model.tree.nodes[word].p_if_no_parent);
    }
  }
}

TEST_F(OpenFabMapIo, RefusesFilesThatDoNotBelongTogether) {
  const fs::path folder = folder_.path() / "model";
  write_openfabmap_model(folder, some_sift_model());
  OpenFabMapReadOptions options;
  const OpenFabMapFiles files = {folder / "vocabulary.yml", folder / "tree.yml", folder / "bow.yml"};
  options.features.kind = {DetectorKind::Orb, DescriptorKind::Orb};
  EXPECT_THAT(input_error_of([&] { read_openfabmap_model(files, options); }), HasSubstr("words of 128 numbers, but orb"));
  options.features.kind = {DetectorKind::Sift, DescriptorKind::Sift};
  folder_.write("model/tree.yml", kOpenFabmapTree);
  EXPECT_THAT(input_error_of([&] { read_openfabmap_model(files, options); }), HasSubstr("tree.yml: is about 4 words"));
  write_openfabmap_model(folder, some_sift_model(), {{}, OutputFolder::IfExists::Replace});
  folder_.write("model/bow.yml", matrix("BOWImageDescs", 1, 2, "f", "1., 0."));
  EXPECT_THAT(input_error_of([&] { read_openfabmap_model(files, options); }), HasSubstr("bow.yml: is about 2 words"));
}

TEST_F(OpenFabMapIo, RefusesToOverwriteUnlessAsked) {
  const fs::path folder = folder_.path() / "model";
  write_openfabmap_model(folder, some_sift_model());
  EXPECT_THROW(write_openfabmap_model(folder, some_sift_model()), InputError);
  EXPECT_NO_THROW(write_openfabmap_model(folder, some_sift_model(), {{}, OutputFolder::IfExists::Replace}));
}

}  // namespace
}  // namespace fabloop
