// SPDX-License-Identifier: BSD-3-Clause
#include "posegraph/g2o/similarity_g2o_io.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "frontend/error.h"
#include "frontend/output_file.h"
#include "posegraph/g2o/g2o_line.h"
#include "posegraph/g2o/g2o_line_reader.h"

namespace fabloop {
namespace {

using namespace g2o;

constexpr const char* kSimilarityTags = "VERTEX_SIM3:QUAT, EDGE_SIM3:QUAT, VERTEX_SIM3:EXPMAP, EDGE_SIM3:EXPMAP and FIX";
constexpr std::size_t kInformationSize = 28;

/// How a line writes a similarity.
enum class Form {
  Quaternion,   ///< x y z qx qy qz qw s.
  Exponential,  ///< Rotation, translation and scale of the logarithm.
};

std::size_t size_of(Form form) { return form == Form::Quaternion ? 8 : 7; }
const char* columns_of(Form form) { return form == Form::Quaternion ? "x y z qx qy qz qw s" : "wx wy wz ux uy uz sigma"; }

/// From the order rotation, translation, scale to ours.
Matrix7d translation_first(const Matrix7d& rotation_first) {
  constexpr std::array<int, 7> kFrom = {3, 4, 5, 0, 1, 2, 6};
  Matrix7d result;
  for (int row = 0; row < 7; ++row) {
    for (int column = 0; column < 7; ++column) result(row, column) = rotation_first(kFrom[row], kFrom[column]);
  }
  return result;
}

class SimilarityReader {
 public:
  SimilarityReader(const std::filesystem::path& path, const G2oOptions& options) : path_(path), lines_(path, options) {}

  SimilarityGraph read() {
    lines_.read([this](const Words& words) { read_line(words); });
    if (graph_.vertices.empty() && graph_.edges.empty()) {
      throw InputError(path_.string() + ": has no vertices and no edges; such a file has lines of " + kSimilarityTags);
    }
    finish();
    return std::move(graph_);
  }

 private:
  void read_line(const Words& words) {
    const std::string_view tag = words.front();
    if (tag == "VERTEX_SIM3:QUAT") return read_vertex(words, Form::Quaternion);
    if (tag == "VERTEX_SIM3:EXPMAP") return read_vertex(words, Form::Exponential);
    if (tag == "EDGE_SIM3:QUAT") return read_edge(words, Form::Quaternion);
    if (tag == "EDGE_SIM3:EXPMAP") return read_edge(words, Form::Exponential);
    lines_.fail_at_unknown_tag(tag, kSimilarityTags);
  }

  void read_vertex(const Words& words, Form form) {
    constexpr std::size_t kColumnsWithCalibration = 2 + 7 + 4;
    if (form != Form::Exponential || words.size() != kColumnsWithCalibration) {
      lines_.expect_columns(words, 2 + size_of(form), std::string("id ") + columns_of(form));
    }
    const std::int64_t id = lines_.id(words[1]);
    lines_.add_vertex(id);
    graph_.vertices.push_back({id, similarity(words, 2, form), false});
  }

  void read_edge(const Words& words, Form form) {
    const std::size_t information = 3 + size_of(form);
    lines_.expect_columns(words, information + kInformationSize,
                          std::string("i j ") + columns_of(form) + " and 28 information entries of the upper triangle");
    const std::int64_t from_id = lines_.id(words[1]);
    const std::int64_t to_id = lines_.id(words[2]);
    if (from_id == to_id) lines_.fail("the edge joins vertex " + text_of(words[1]) + " to itself; remove it");
    SimilarityEdge edge;
    edge.from_from_to = similarity(words, 3, form);
    edge.information = lines_.triangle(words, information, 7);
    if (form == Form::Exponential) edge.information = translation_first(edge.information);
    edge.kind = lines_.take_kind(from_id, to_id);
    graph_.edges.push_back(edge);
    ends_.push_back({from_id, to_id, lines_.line()});
  }

  Similarity similarity(const Words& words, std::size_t start, Form form) const {
    if (form == Form::Exponential) {
      Vector7d coordinates;
      coordinates << lines_.vector(words, start + 3), lines_.vector(words, start), lines_.number(words[start + 6]);
      return similarity_from_log(coordinates);
    }
    const double scale = lines_.number(words[start + 7]);
    if (!(scale > 0.0)) lines_.fail("the scale " + quoted(words[start + 7]) + " is not positive; correct or remove the line");
    return {scale, lines_.quaternion(words, start + 3), lines_.vector(words, start)};
  }

  void finish() {
    const bool chain = graph_.vertices.empty();
    if (chain) {
      std::set<std::int64_t> ids;
      for (const Ends& ends : ends_) ids.insert({ends.from_id, ends.to_id});
      for (const std::int64_t id : ids) {
        lines_.add_vertex(id);
        graph_.vertices.push_back({id, {}, false});
      }
    }
    for (const std::size_t v : lines_.fixed()) graph_.vertices[v].fixed = true;
    for (std::size_t e = 0; e < ends_.size(); ++e) {
      graph_.edges[e].from = lines_.position(ends_[e].from_id, ends_[e].line);
      graph_.edges[e].to = lines_.position(ends_[e].to_id, ends_[e].line);
    }
    if (chain) chain_along_edges(graph_);
    lines_.warn(chain, graph_.edges.size());
  }

  /// Of an edge, while they are ids.
  struct Ends {
    std::int64_t from_id = 0;
    std::int64_t to_id = 0;
    int line = 0;
  };

  const std::filesystem::path& path_;
  LineReader lines_;
  SimilarityGraph graph_;
  std::vector<Ends> ends_;
};

void write_similarity(std::ostream& out, const Similarity& similarity) {
  const auto& [s, q, t] = similarity;
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(), s}) write_number(out, value);
}

}  // namespace

bool has_similarities(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) throw InputError(path.string() + ": cannot be read; is it a file?");
  for (std::string line; std::getline(file, line);) {
    Words words;
    split(line, words);
    if (words.empty()) continue;
    const bool is_graph = words.front().starts_with("VERTEX") || words.front().starts_with("EDGE");
    if (is_graph) return words.front().starts_with("VERTEX_SIM3") || words.front().starts_with("EDGE_SIM3");
  }
  return false;
}

SimilarityGraph read_similarity_g2o(const std::filesystem::path& path, const G2oOptions& options) {
  return SimilarityReader(path, options).read();
}

void write_g2o(const std::filesystem::path& path, const SimilarityGraph& graph) {
  check(graph);
  OutputFile file(path);
  std::ostream& out = file.stream();
  out << "# SIM3:QUAT: x y z qx qy qz qw s, x_in_i = s R x_in_j + t for edges i j, world_from_frame for vertices; information:\n"
         "# 28 upper-triangular entries in the order translation, rotation, log s, of the error i_from_j^-1 i_from_j_true.\n";
  const auto usual = [&](const SimilarityEdge& edge) {
    return usual_kind(graph.vertices[edge.from].id, graph.vertices[edge.to].id);
  };
  const auto is_unusual = [&](const SimilarityEdge& edge) { return edge.kind != usual(edge); };
  if (std::any_of(graph.edges.begin(), graph.edges.end(), is_unusual)) out << kKindExplanation;
  for (const SimilarityVertex& vertex : graph.vertices) {
    out << "VERTEX_SIM3:QUAT " << vertex.id;
    write_similarity(out, vertex.world_from_frame);
    out << '\n';
  }
  for (const SimilarityVertex& vertex : graph.vertices) {
    if (vertex.fixed) out << "FIX " << vertex.id << '\n';
  }
  for (const SimilarityEdge& edge : graph.edges) {
    if (is_unusual(edge)) out << kind_comment(edge.kind);
    out << "EDGE_SIM3:QUAT " << graph.vertices[edge.from].id << ' ' << graph.vertices[edge.to].id;
    write_similarity(out, edge.from_from_to);
    for (int i = 0; i < 7; ++i) {
      for (int j = i; j < 7; ++j) write_number(out, edge.information(i, j));
    }
    out << '\n';
  }
  file.commit();
}

}  // namespace fabloop
