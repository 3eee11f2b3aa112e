// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/npy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

using testing::HasSubstr;

const std::string kMagic("\x93NUMPY", 6);

/// A file as numpy.save writes it: format 1.0 with this dictionary, then these bytes.
std::string npy_bytes(std::string header, const std::string& data) {
  header.resize(64 - 10 - 1 + (header.size() > 53 ? 64 : 0), ' ');
  header += '\n';
  return kMagic + std::string("\x01\x00", 2) + static_cast<char>(header.size()) + '\0' + header + data;
}

std::vector<std::vector<double>> read_all(const std::filesystem::path& path) {
  NpyReader reader(path);
  std::vector<std::vector<double>> rows(reader.num_rows(), std::vector<double>(reader.num_columns()));
  for (auto& row : rows) reader.read_row(row);
  return rows;
}

TEST(Npy, WhatIsWrittenIsRead) {
  const TemporaryFolder folder;
  const std::vector<std::vector<double>> rows = {{0.1, -2e300, 3}, {std::numeric_limits<double>::infinity(), 0, 1e-300}};
  NpyWriter writer(folder.path() / "a.npy", NpyType::Float64, 3);
  for (const auto& row : rows) writer.add_row(row);
  writer.commit();
  EXPECT_EQ(NpyReader(folder.path() / "a.npy").type(), NpyType::Float64);
  EXPECT_EQ(read_all(folder.path() / "a.npy"), rows);
}

TEST(Npy, NarrowTypesRound) {
  const TemporaryFolder folder;
  for (const NpyType type : {NpyType::Float32, NpyType::UInt8}) {
    NpyWriter writer(folder.path() / "a.npy", type, 2);
    writer.add_row(std::vector<double>{1, 200});
    writer.commit();
    EXPECT_EQ(read_all(folder.path() / "a.npy"), (std::vector<std::vector<double>>{{1, 200}}));
  }
}

TEST(Npy, ShortRowsAreFilledUp) {
  const TemporaryFolder folder;
  NpyWriter writer(folder.path() / "a.npy", NpyType::Float32, 3);
  writer.add_row({}, 7.0);
  writer.add_row(std::vector<double>{1, 2}, std::numeric_limits<double>::quiet_NaN());
  writer.commit();
  const auto rows = read_all(folder.path() / "a.npy");
  EXPECT_EQ(rows[0], (std::vector<double>{7, 7, 7}));
  EXPECT_EQ(rows[1][1], 2.0);
  EXPECT_TRUE(std::isnan(rows[1][2]));
}

TEST(Npy, TheHeaderIsWhatTheFormatAsksFor) {
  const TemporaryFolder folder;
  NpyWriter writer(folder.path() / "a.npy", NpyType::Float64, 1);
  writer.add_row(std::vector<double>{1.0});
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.npy")) << "before it is complete";
  writer.commit();
  std::ifstream file(folder.path() / "a.npy", std::ios::binary);
  std::string head(128, '\0');
  file.read(head.data(), 128);
  EXPECT_TRUE(head.starts_with(kMagic + std::string("\x01\x00\x76\x00", 4)));
  EXPECT_THAT(head, HasSubstr("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1), }"));
  EXPECT_EQ(head.back(), '\n');
}

TEST(Npy, OtherTypesAndVersionsAreRead) {
  const TemporaryFolder folder;
  const auto longs = folder.write("long.npy", npy_bytes("{'descr': '<i8', 'fortran_order': False, 'shape': (1, 2), }",
                                                        std::string("\x05\0\0\0\0\0\0\0\xff\xff\xff\xff\xff\xff\xff\xff", 16)));
  EXPECT_EQ(read_all(longs), (std::vector<std::vector<double>>{{5, -1}}));
  const auto bools =
      folder.write("bool.npy", npy_bytes("{\"shape\":(2,1),\"fortran_order\":False,\"descr\":\"|b1\"}", std::string("\1\0", 2)));
  EXPECT_EQ(read_all(bools), (std::vector<std::vector<double>>{{1}, {0}}));
  std::string header = "{'descr': '|u1', 'fortran_order': False, 'shape': (1, 1), }\n";
  const auto second = folder.write("second.npy", kMagic + std::string("\x02\x00", 2) + static_cast<char>(header.size()) +
                                                     std::string(3, '\0') + header + "\x09");
  EXPECT_EQ(read_all(second), (std::vector<std::vector<double>>{{9}}));
}

TEST(Npy, BadFilesAreRefused) {
  const TemporaryFolder folder;
  const std::string good = npy_bytes("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2), }", std::string(8, '\0'));
  const auto error_of = [&](const std::string& bytes) {
    const auto path = folder.write("bad.npy", bytes);
    return input_error_of([&] { NpyReader reader(path); });
  };
  EXPECT_NO_THROW(NpyReader(folder.write("good.npy", good)));
  EXPECT_THAT(error_of(""), HasSubstr("bad.npy: "));
  EXPECT_THAT(error_of("0 1\n1 0\n"), HasSubstr("no NumPy file"));
  EXPECT_THAT(error_of(good.substr(0, 40)), HasSubstr("within its header"));
  EXPECT_THAT(error_of(good.substr(0, good.size() - 1)), HasSubstr("does not fit"));
  EXPECT_THAT(error_of(good + "x"), HasSubstr("does not fit"));
  const auto with_header = [&](const std::string& header) { return error_of(npy_bytes(header, std::string(8, '\0'))); };
  EXPECT_THAT(with_header("{'descr': '>f4', 'fortran_order': False, 'shape': (1, 2), }"), HasSubstr("'>f4'"));
  EXPECT_THAT(with_header("{'descr': '<c8', 'fortran_order': False, 'shape': (1, 1), }"), HasSubstr("'<c8'"));
  EXPECT_THAT(with_header("{'descr': '<f4', 'fortran_order': True, 'shape': (1, 2), }"), HasSubstr("by columns"));
  EXPECT_THAT(with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }"), HasSubstr("2-D"));
  EXPECT_THAT(with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2), }"), HasSubstr("2-D"));
  EXPECT_THAT(with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (4611686018427387904, 4), }"),
              HasSubstr("does not fit"));
  EXPECT_THAT(with_header("nonsense"), HasSubstr("2-D"));
  EXPECT_THAT(input_error_of([&] { NpyReader reader(folder.path() / "absent.npy"); }), HasSubstr("absent.npy"));
}

}  // namespace
}  // namespace fabloop
