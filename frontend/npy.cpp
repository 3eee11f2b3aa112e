// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/npy.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <charconv>
#include <cstring>
#include <functional>
#include <istream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "frontend/error.h"

namespace fabloop {
namespace {

static_assert(std::endian::native == std::endian::little, "entries are written as they stand in memory");

constexpr std::string_view kNpyMagic("\x93NUMPY", 6);
/// Room for any shape, and a multiple of 64 as the format asks for.
constexpr std::size_t kHeaderBytes = 128;
constexpr std::size_t kPreambleBytes = 10;
constexpr std::size_t kMaxHeaderBytes = 65536;

struct TypeName {
  NpyType type;
  std::string_view name;
  std::size_t bytes;
};

constexpr std::array<TypeName, 11> kTypes{{{NpyType::Float64, "<f8", 8},
                                           {NpyType::Float32, "<f4", 4},
                                           {NpyType::UInt8, "|u1", 1},
                                           {NpyType::Int8, "|i1", 1},
                                           {NpyType::Bool, "|b1", 1},
                                           {NpyType::UInt16, "<u2", 2},
                                           {NpyType::Int16, "<i2", 2},
                                           {NpyType::UInt32, "<u4", 4},
                                           {NpyType::Int32, "<i4", 4},
                                           {NpyType::UInt64, "<u8", 8},
                                           {NpyType::Int64, "<i8", 8}}};

const TypeName& type_name(NpyType type) {
  return *std::find_if(kTypes.begin(), kTypes.end(), [&](const TypeName& name) { return name.type == type; });
}

/// Calls `body` with a value of the C++ type that the entries have.
template <typename Body>
void with_entry_type(NpyType type, const Body& body) {
  switch (type) {
    case NpyType::Float64:
      return body(double{});
    case NpyType::Float32:
      return body(float{});
    case NpyType::UInt8:
    case NpyType::Bool:
      return body(std::uint8_t{});
    case NpyType::Int8:
      return body(std::int8_t{});
    case NpyType::UInt16:
      return body(std::uint16_t{});
    case NpyType::Int16:
      return body(std::int16_t{});
    case NpyType::UInt32:
      return body(std::uint32_t{});
    case NpyType::Int32:
      return body(std::int32_t{});
    case NpyType::UInt64:
      return body(std::uint64_t{});
    case NpyType::Int64:
      return body(std::int64_t{});
  }
}

/// The text after `key` in the header's dictionary; none where it has no such key.
std::optional<std::string_view> value_of(std::string_view header, std::string_view key) {
  for (const char quote : {'\'', '"'}) {
    const std::string quoted = quote + std::string(key) + quote;
    const std::size_t at = header.find(quoted);
    if (at == std::string_view::npos) continue;
    std::string_view rest = header.substr(at + quoted.size());
    const std::size_t start = rest.find_first_not_of(" :");
    if (start == std::string_view::npos) return std::nullopt;
    return rest.substr(start);
  }
  return std::nullopt;
}

/// "(2, 3)": the two numbers; none for another number of dimensions.
std::optional<std::array<std::size_t, 2>> parse_shape(std::string_view text) {
  std::array<std::size_t, 2> shape{};
  if (text.empty() || text.front() != '(') return std::nullopt;
  const char* at = text.data() + 1;
  const char* const end = text.data() + text.size();
  const auto skip = [&](char c) {
    while (at != end && (*at == ' ' || *at == c)) ++at;
  };
  for (std::size_t& size : shape) {
    skip(' ');
    const auto [after, error] = std::from_chars(at, end, size);
    if (error != std::errc()) return std::nullopt;
    at = after;
    skip(',');
  }
  if (at == end || *at != ')') return std::nullopt;
  return shape;
}

/// Throws InputError that names the file.
using Fail = std::function<void(const std::string& what)>;

/// The dictionary between the magic and the entries.
std::string read_header_text(std::istream& file, const Fail& fail) {
  std::array<char, 12> preamble{};
  file.read(preamble.data(), kPreambleBytes);
  if (!file || std::string_view(preamble.data(), kNpyMagic.size()) != kNpyMagic) fail("is no NumPy file");
  const int version = preamble[6];
  if (version < 1 || version > 3) fail("is of NumPy format " + std::to_string(version) + ", which is unknown");
  // Format 1 has a length of 2 bytes, the later ones of 4.
  if (version > 1) file.read(preamble.data() + kPreambleBytes, 2);
  std::uint32_t length = 0;
  std::memcpy(&length, preamble.data() + 8, version > 1 ? 4 : 2);
  if (length > kMaxHeaderBytes) fail("has a damaged header");
  std::string text(length, '\0');
  file.read(text.data(), static_cast<std::streamsize>(length));
  if (!file) fail("ends within its header");
  return text;
}

struct Header {
  const TypeName* type;
  std::size_t num_rows, num_columns;
};

Header parse_header(std::string_view text, const Fail& fail) {
  const auto descr = value_of(text, "descr");
  const auto order = value_of(text, "fortran_order");
  const auto shape = parse_shape(value_of(text, "shape").value_or(""));
  if (!descr || !order || !shape) fail("has no header of a 2-D array");
  if (!order->starts_with("False")) fail("is stored by columns (fortran_order)");
  const auto known = std::find_if(kTypes.begin(), kTypes.end(), [&](const TypeName& name) {
    return descr->size() > name.name.size() && descr->substr(1).starts_with(name.name);
  });
  if (known == kTypes.end()) fail("has entries of type " + std::string(descr->substr(0, descr->find(','))));
  return {&*known, (*shape)[0], (*shape)[1]};
}

}  // namespace

NpyWriter::NpyWriter(const std::filesystem::path& path, NpyType type, std::size_t num_columns)
    : file_(path), type_(type), num_columns_(num_columns), bytes_(num_columns * type_name(type).bytes) {
  assert((type == NpyType::Float64 || type == NpyType::Float32 || type == NpyType::UInt8) && "no other type is written");
  write_header();
}

void NpyWriter::add_row(std::span<const double> row, double fill) {
  assert(row.size() <= num_columns_);
  with_entry_type(type_, [&](auto entry) {
    for (std::size_t i = 0; i < num_columns_; ++i) {
      entry = static_cast<decltype(entry)>(i < row.size() ? row[i] : fill);
      std::memcpy(bytes_.data() + i * sizeof(entry), &entry, sizeof(entry));
    }
  });
  file_.stream().write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
  ++num_rows_;
}

void NpyWriter::commit() {
  // Only now is the number of rows known.
  file_.stream().seekp(0);
  write_header();
  file_.commit();
}

void NpyWriter::write_header() {
  std::string text = "{'descr': '" + std::string(type_name(type_).name) + "', 'fortran_order': False, 'shape': (" +
                     std::to_string(num_rows_) + ", " + std::to_string(num_columns_) + "), }";
  text.resize(kHeaderBytes - kPreambleBytes - 1, ' ');
  text += '\n';
  const std::array<char, 4> version_and_length{1, 0, static_cast<char>(text.size()), 0};
  file_.stream() << kNpyMagic;
  file_.stream().write(version_and_length.data(), version_and_length.size());
  file_.stream() << text;
}

NpyReader::NpyReader(const std::filesystem::path& path) : path_(path), file_(path, std::ios::binary) {
  const auto fail = [&](const std::string& what) {
    throw InputError(path.string() + ": " + what + "; write it with numpy.save from a 2-D array of numbers");
  };
  std::error_code error;
  const std::uintmax_t file_size = std::filesystem::file_size(path, error);
  if (!file_ || error) throw InputError(path.string() + ": cannot be read; does the file exist?");
  const Header header = parse_header(read_header_text(file_, fail), fail);
  type_ = header.type->type;
  num_rows_ = header.num_rows;
  num_columns_ = header.num_columns;
  const std::uintmax_t data_size = file_size - static_cast<std::uintmax_t>(file_.tellg());
  const std::size_t bytes = header.type->bytes;
  const bool overflows = num_columns_ != 0 && num_rows_ > std::numeric_limits<std::uintmax_t>::max() / num_columns_ / bytes;
  if (overflows || data_size != num_rows_ * num_columns_ * bytes) {
    fail("has " + std::to_string(data_size) + " bytes of entries, which does not fit its shape of " + std::to_string(num_rows_) +
         " x " + std::to_string(num_columns_));
  }
  bytes_.resize(num_columns_ * bytes);
}

void NpyReader::read_row(std::span<double> row) {
  assert(row.size() == num_columns_);
  file_.read(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
  if (!file_) throw InputError(path_.string() + ": cannot be read to its end; copy it again");
  with_entry_type(type_, [&](auto entry) {
    for (std::size_t i = 0; i < num_columns_; ++i) {
      std::memcpy(&entry, bytes_.data() + i * sizeof(entry), sizeof(entry));
      row[i] = static_cast<double>(entry);
    }
  });
}

}  // namespace fabloop
