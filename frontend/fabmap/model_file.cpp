// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "frontend/error.h"
#include "frontend/fabmap/model.h"
#include "frontend/features/feature_settings.h"
#include "frontend/mapped_file.h"
#include "frontend/output_file.h"

namespace fabloop {
namespace {

// A model file is: magic, version (u32), length of the header (u32), header (JSON, padded with spaces), arrays. Every array
// starts at a multiple of kAlignment, so that the file can be mapped into memory. Numbers are little-endian.
static_assert(std::endian::native == std::endian::little, "model files are read and written as they lie in memory");

using HeaderJson = nlohmann::json;

constexpr std::array<char, 8> kMagic = {'F', 'A', 'B', 'L', 'O', 'O', 'P', 'M'};
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kPrefixSize = kMagic.size() + 2 * sizeof(std::uint32_t);
constexpr std::size_t kAlignment = 64;
constexpr std::uint32_t kRoot = std::numeric_limits<std::uint32_t>::max();

std::size_t aligned(std::size_t size) { return (size + kAlignment - 1) / kAlignment * kAlignment; }

/// The arrays of a model file, in their order in it.
struct Arrays {
  std::vector<float> words;                      ///< W x D.
  std::vector<std::uint32_t> parent;             ///< W, kRoot for none.
  std::vector<double> p;                         ///< W.
  std::vector<double> p_if_parent;               ///< W.
  std::vector<double> p_if_no_parent;            ///< W.
  std::vector<std::uint64_t> background_starts;  ///< Where each background observation starts, and the end of the last one.
  std::vector<std::uint32_t> background_words;   ///< All of them, one after another.
};

template <typename Visitor>
void for_each_array(Arrays& arrays, Visitor&& visit) {
  visit(arrays.words);
  visit(arrays.parent);
  visit(arrays.p);
  visit(arrays.p_if_parent);
  visit(arrays.p_if_no_parent);
  visit(arrays.background_starts);
  visit(arrays.background_words);
}

Arrays arrays_of(const Model& model) {
  Arrays arrays;
  const auto* words = model.vocabulary.words.ptr<float>();
  arrays.words.assign(words, words + model.vocabulary.words.total());
  for (const ChowLiuNode& node : model.tree.nodes) {
    arrays.parent.push_back(node.parent.value_or(kRoot));
    arrays.p.push_back(node.p);
    arrays.p_if_parent.push_back(node.p_if_parent);
    arrays.p_if_no_parent.push_back(node.p_if_no_parent);
  }
  arrays.background_starts.push_back(0);
  for (const Observation& observation : model.background) {
    arrays.background_words.insert(arrays.background_words.end(), observation.words.begin(), observation.words.end());
    arrays.background_starts.push_back(arrays.background_words.size());
  }
  return arrays;
}

/// What training says of itself, where it did.
void add_training_entries(const Model& model, HeaderJson& header) {
  if (model.health) header["health"] = HeaderJson::parse(to_json(*model.health));
  if (model.domain) header["domain"] = HeaderJson::parse(to_json(*model.domain));
}

void read_training_entries(const HeaderJson& header, Model& model) {
  if (header.contains("health")) model.health = training_report_from_json(header["health"].dump());
  if (header.contains("domain")) model.domain = domain_from_json(header["domain"].dump());
}

HeaderJson header_of(const Model& model, const Arrays& arrays) {
  return {{"words", model.vocabulary.words.rows},
          {"dimensions", model.vocabulary.words.cols},
          {"background", model.background.size()},
          {"background_words", arrays.background_words.size()},
          {"features", HeaderJson::parse(feature_options_json(model.features))},
          {"detector",
           {{"p_seen_if_present", model.detector.p_seen_if_present}, {"p_seen_if_absent", model.detector.p_seen_if_absent}}},
          {"provenance",
           {{"fabloop_version", model.provenance.fabloop_version},
            {"command", model.provenance.command},
            {"seed", model.provenance.seed},
            {"num_images", model.provenance.num_images},
            {"num_descriptors", model.provenance.num_descriptors}}}};
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw InputError(path.string() + ": " + what + "; train the model again (fabloop train)");
}

/// Everything but the arrays.
Model model_of(const HeaderJson& header) {
  Model model;
  model.features = feature_options_from_json(header.at("features").dump());
  const HeaderJson& detector = header.at("detector");
  model.detector = {detector.at("p_seen_if_present").get<double>(), detector.at("p_seen_if_absent").get<double>()};
  const HeaderJson& provenance = header.at("provenance");
  model.provenance.fabloop_version = provenance.at("fabloop_version").get<std::string>();
  model.provenance.command = provenance.at("command").get<std::string>();
  model.provenance.seed = provenance.at("seed").get<std::uint64_t>();
  model.provenance.num_images = provenance.at("num_images").get<std::uint64_t>();
  model.provenance.num_descriptors = provenance.at("num_descriptors").get<std::uint64_t>();
  return model;
}

/// Where the arrays of a model file start in it, and how long they are.
struct Layout {
  std::size_t num_words = 0, dimensions = 0, num_background = 0, num_background_words = 0;
  std::size_t words = 0, parent = 0, p = 0, p_if_parent = 0, p_if_no_parent = 0, background_starts = 0, background_words = 0;
};

/// The layout that the header announces, when it fills the file exactly. No array is touched before that is known.
Layout layout_of(const HeaderJson& header, std::size_t begin, std::size_t file_size) {
  const auto number = [&](const char* name) {
    const auto value = header.at(name).get<std::uint64_t>();
    return value <= file_size ? value : throw InputError("a size that is larger than the file");
  };
  Layout layout;
  layout.num_words = number("words");
  layout.dimensions = number("dimensions");
  layout.num_background = number("background");
  layout.num_background_words = number("background_words");
  constexpr std::size_t kMaxRows = std::numeric_limits<int>::max();
  if (layout.num_words == 0 || layout.dimensions == 0 || layout.num_words > file_size / sizeof(float) / layout.dimensions ||
      layout.num_words > kMaxRows || layout.dimensions > kMaxRows) {
    throw InputError("sizes that do not fit the file's (truncated?)");
  }
  std::size_t end = begin;
  const auto next = [&](std::size_t count, std::size_t element_size) {
    const std::size_t start = end;
    end += aligned(count * element_size);
    return start;
  };
  layout.words = next(layout.num_words * layout.dimensions, sizeof(float));
  layout.parent = next(layout.num_words, sizeof(std::uint32_t));
  layout.p = next(layout.num_words, sizeof(double));
  layout.p_if_parent = next(layout.num_words, sizeof(double));
  layout.p_if_no_parent = next(layout.num_words, sizeof(double));
  layout.background_starts = next(layout.num_background + 1, sizeof(std::uint64_t));
  layout.background_words = next(layout.num_background_words, sizeof(std::uint32_t));
  if (end != file_size) throw InputError("sizes that do not fit the file's (truncated?)");
  return layout;
}

/// An array as it lies in the file: every array starts at a multiple of kAlignment, and so does the mapping.
template <typename Number>
const Number* array_at(const MappedFile& file, std::size_t offset) {
  return reinterpret_cast<const Number*>(file.data() + offset);
}

ChowLiuTree tree_in(const MappedFile& file, const Layout& layout) {
  const auto* parent = array_at<std::uint32_t>(file, layout.parent);
  const auto* p = array_at<double>(file, layout.p);
  const auto* p_if_parent = array_at<double>(file, layout.p_if_parent);
  const auto* p_if_no_parent = array_at<double>(file, layout.p_if_no_parent);
  ChowLiuTree tree;
  tree.nodes.resize(layout.num_words);
  for (std::size_t i = 0; i < layout.num_words; ++i) {
    tree.nodes[i] = {parent[i] == kRoot ? std::nullopt : std::optional(parent[i]), p[i], p_if_parent[i], p_if_no_parent[i]};
  }
  return tree;
}

std::vector<Observation> background_in(const MappedFile& file, const Layout& layout) {
  const auto* starts = array_at<std::uint64_t>(file, layout.background_starts);
  const auto* words = array_at<std::uint32_t>(file, layout.background_words);
  std::vector<Observation> background(layout.num_background);
  for (std::size_t i = 0; i < layout.num_background; ++i) {
    if (starts[i] > starts[i + 1] || starts[i + 1] > layout.num_background_words) {
      throw InputError("a background observation that ends nowhere");
    }
    background[i].words.assign(words + starts[i], words + starts[i + 1]);
  }
  return background;
}

/// The header, and where it ends.
std::pair<HeaderJson, std::size_t> header_in(const MappedFile& file) {
  if (file.size() < kPrefixSize) throw InputError("a file too short for a fabloop model");
  if (std::memcmp(kMagic.data(), file.data(), kMagic.size()) != 0) throw InputError("something else than a fabloop model");
  std::array<std::uint32_t, 2> numbers{};
  std::memcpy(numbers.data(), file.data() + kMagic.size(), sizeof(numbers));
  const auto [version, header_size] = numbers;
  if (version != kVersion) {
    throw InputError("model format " + std::to_string(version) + " where this program reads " + std::to_string(kVersion));
  }
  if (header_size > file.size() - kPrefixSize || (kPrefixSize + header_size) % kAlignment != 0) {
    throw InputError("a header that the file is too short for");
  }
  const auto* text = reinterpret_cast<const char*>(file.data() + kPrefixSize);
  return {HeaderJson::parse(text, text + header_size), kPrefixSize + header_size};
}

Model parse(MappedFile file) {
  const auto [header, end] = header_in(file);
  Model model = model_of(header);
  read_training_entries(header, model);
  const Layout layout = layout_of(header, end, file.size());
  model.tree = tree_in(file, layout);
  model.background = background_in(file, layout);
  model.vocabulary.words =
      matrix_of(std::move(file), layout.words, static_cast<int>(layout.num_words), static_cast<int>(layout.dimensions), CV_32F);
  return model;
}

}  // namespace

bool is_model_file(const std::filesystem::path& path) {
  std::array<char, kMagic.size()> magic{};
  std::ifstream stream(path, std::ios::binary);
  return stream.read(magic.data(), magic.size()) && magic == kMagic;
}

Model read_model(const std::filesystem::path& path) {
  MappedFile file(path);
  Model model;
  try {
    model = parse(std::move(file));
  } catch (const HeaderJson::exception&) {
    fail(path, "is not a valid model (its header cannot be understood)");
  } catch (const InputError& problem) {
    fail(path, std::string("is not a valid model (it has ") + problem.what() + ")");
  }
  validate(model, path.string());
  return model;
}

void write_model(const std::filesystem::path& path, const Model& model) {
  validate(model, path.string());
  Arrays arrays = arrays_of(model);
  HeaderJson header_json = header_of(model, arrays);
  add_training_entries(model, header_json);
  std::string header = header_json.dump(1);
  header.resize(aligned(kPrefixSize + header.size()) - kPrefixSize, ' ');
  OutputFile file(path);
  const std::array<std::uint32_t, 2> numbers = {kVersion, static_cast<std::uint32_t>(header.size())};
  file.stream().write(kMagic.data(), kMagic.size());
  file.stream().write(reinterpret_cast<const char*>(numbers.data()), sizeof(numbers));
  file.stream().write(header.data(), static_cast<std::streamsize>(header.size()));
  for_each_array(arrays, [&](const auto& array) {
    const std::size_t size = array.size() * sizeof(array[0]);
    const std::array<char, kAlignment> padding{};
    file.stream().write(reinterpret_cast<const char*>(array.data()), static_cast<std::streamsize>(size));
    file.stream().write(padding.data(), static_cast<std::streamsize>(aligned(size) - size));
  });
  file.commit();
}

}  // namespace fabloop
