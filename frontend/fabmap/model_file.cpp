// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "frontend/error.h"
#include "frontend/fabmap/model.h"
#include "frontend/features/feature_settings.h"
#include "frontend/output_file.h"

namespace fabloop {
namespace {

// A model file is: magic, version (u32), length of the header (u32), header (JSON, padded with spaces), arrays. Every array
// starts at a multiple of kAlignment, so that the file can be mapped into memory. Numbers are little-endian.
static_assert(std::endian::native == std::endian::little, "model files are read and written as they lie in memory");

using Json = nlohmann::json;

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

Json header_of(const Model& model, const Arrays& arrays) {
  return {{"words", model.vocabulary.words.rows},
          {"dimensions", model.vocabulary.words.cols},
          {"background", model.background.size()},
          {"background_words", arrays.background_words.size()},
          {"features", Json::parse(feature_options_json(model.features))},
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
Model model_of(const Json& header) {
  Model model;
  model.features = feature_options_from_json(header.at("features").dump());
  const Json& detector = header.at("detector");
  model.detector = {detector.at("p_seen_if_present").get<double>(), detector.at("p_seen_if_absent").get<double>()};
  const Json& provenance = header.at("provenance");
  model.provenance.fabloop_version = provenance.at("fabloop_version").get<std::string>();
  model.provenance.command = provenance.at("command").get<std::string>();
  model.provenance.seed = provenance.at("seed").get<std::uint64_t>();
  model.provenance.num_images = provenance.at("num_images").get<std::uint64_t>();
  model.provenance.num_descriptors = provenance.at("num_descriptors").get<std::uint64_t>();
  return model;
}

/// Room for what the header announces, or none when that does not fill exactly `size` bytes after the header. Nothing is
/// allocated before the sizes are known to be those of the file.
std::optional<Arrays> allocate(const Json& header, std::size_t size) {
  const auto number = [&](const char* name) {
    const auto value = header.at(name).get<std::uint64_t>();
    return value <= size ? value : throw InputError("a size that is larger than the file");
  };
  const std::uint64_t words = number("words"), dimensions = number("dimensions");
  const std::uint64_t background = number("background"), background_words = number("background_words");
  if (words == 0 || dimensions == 0 || words > size / sizeof(float) / dimensions) return std::nullopt;
  const std::uint64_t expected = aligned(words * dimensions * sizeof(float)) + aligned(words * sizeof(std::uint32_t)) +
                                 3 * aligned(words * sizeof(double)) + aligned((background + 1) * sizeof(std::uint64_t)) +
                                 aligned(background_words * sizeof(std::uint32_t));
  if (expected != size) return std::nullopt;
  Arrays arrays;
  arrays.words.resize(words * dimensions);
  for (auto* array : {&arrays.p, &arrays.p_if_parent, &arrays.p_if_no_parent}) array->resize(words);
  arrays.parent.resize(words);
  arrays.background_starts.resize(background + 1);
  arrays.background_words.resize(background_words);
  return arrays;
}

void move_into(Model& model, const Arrays& arrays, int dimensions) {
  const auto num_words = static_cast<int>(arrays.parent.size());
  model.vocabulary.words = cv::Mat(num_words, dimensions, CV_32F);
  std::memcpy(model.vocabulary.words.data, arrays.words.data(), arrays.words.size() * sizeof(float));
  for (std::size_t i = 0; i < arrays.parent.size(); ++i) {
    const auto parent = arrays.parent[i] == kRoot ? std::nullopt : std::optional(arrays.parent[i]);
    model.tree.nodes.push_back({parent, arrays.p[i], arrays.p_if_parent[i], arrays.p_if_no_parent[i]});
  }
  for (std::size_t i = 0; i + 1 < arrays.background_starts.size(); ++i) {
    const std::uint64_t begin = arrays.background_starts[i], end = arrays.background_starts[i + 1];
    if (begin > end || end > arrays.background_words.size()) throw InputError("a background observation that ends nowhere");
    const auto first = arrays.background_words.begin();
    model.background.push_back({{first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(end)}});
  }
}

Model parse(std::ifstream& stream, std::uint64_t file_size) {
  std::array<char, kPrefixSize> prefix{};
  if (!stream.read(prefix.data(), prefix.size())) throw InputError("a file too short for a fabloop model");
  if (!std::equal(kMagic.begin(), kMagic.end(), prefix.begin())) throw InputError("something else than a fabloop model");
  std::array<std::uint32_t, 2> numbers{};
  std::memcpy(numbers.data(), prefix.data() + kMagic.size(), sizeof(numbers));
  const auto [version, header_size] = numbers;
  if (version != kVersion) {
    throw InputError("model format " + std::to_string(version) + " where this program reads " + std::to_string(kVersion));
  }
  if (header_size > file_size - kPrefixSize || (kPrefixSize + header_size) % kAlignment != 0) {
    throw InputError("a header that the file is too short for");
  }
  std::string text(header_size, ' ');
  stream.read(text.data(), header_size);
  const Json header = Json::parse(text);
  Model model = model_of(header);
  std::optional<Arrays> arrays = allocate(header, file_size - kPrefixSize - header_size);
  if (!arrays) throw InputError("sizes that do not fit the file's (truncated?)");
  for_each_array(*arrays, [&](auto& array) {
    const std::size_t size = array.size() * sizeof(array[0]);
    std::array<char, kAlignment> padding{};
    stream.read(reinterpret_cast<char*>(array.data()), static_cast<std::streamsize>(size));
    stream.read(padding.data(), static_cast<std::streamsize>(aligned(size) - size));
  });
  if (!stream) throw InputError("an end before its time");
  move_into(model, *arrays, header.at("dimensions").get<int>());
  return model;
}

}  // namespace

Model read_model(const std::filesystem::path& path) {
  std::error_code error;
  const std::uint64_t file_size = std::filesystem::file_size(path, error);
  std::ifstream stream(path, std::ios::binary);
  if (error || !stream) throw InputError(path.string() + ": cannot be read; give the file that `fabloop train` wrote");
  Model model;
  try {
    model = parse(stream, file_size);
  } catch (const Json::exception&) {
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
  std::string header = header_of(model, arrays).dump(1);
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
