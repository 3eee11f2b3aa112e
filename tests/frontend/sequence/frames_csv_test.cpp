// SPDX-License-Identifier: BSD-3-Clause
#include "frontend/sequence/frames_csv.h"

#include <gmock/gmock.h>

#include "tests/frontend/sequence/temporary_folder.h"

namespace fabloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(FramesCsv, ToleratesHeadersCommentsAndWindowsLineEnds) {
  const TemporaryFolder folder;
  for (const std::string head : {"# filename,timestamp_s\r\n", "filename,timestamp_s\r\n",
                                 "\xEF\xBB\xBF"
                                 "filename,timestamp_s\n\n",
                                 ""}) {
    const auto images =
        read_frames_csv(folder.write("frames.csv", head + "a.jpg,1500000000.000000001\r\n# note\n b.jpg , 1500000001.5 ,7\n"));
    ASSERT_EQ(images.size(), 2u);
    EXPECT_EQ(images[0].filename, "a.jpg");
    EXPECT_EQ(images[0].time_ns, 1500000000000000001);
    EXPECT_EQ(images[1].filename, "b.jpg");
    EXPECT_EQ(images[1].time_ns, 1500000001500000000);
  }
}

TEST(FramesCsv, ABadLineIsNamed) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& line) {
    const auto path = folder.write("frames.csv", "a.jpg,10\n" + line + "\n");
    return input_error_of([&] { read_frames_csv(path); });
  };
  EXPECT_THAT(message("b.jpg"), AllOf(HasSubstr("frames.csv:2"), HasSubstr("no comma")));
  EXPECT_THAT(message(",11"), AllOf(HasSubstr("frames.csv:2"), HasSubstr("no file name")));
  EXPECT_THAT(message("b.jpg,noon"), AllOf(HasSubstr("frames.csv:2"), HasSubstr("'noon' is not a time")));
  EXPECT_THAT(message("b.jpg,10"), AllOf(HasSubstr("frames.csv:2"), HasSubstr("'b.jpg' does not ascend")));
  EXPECT_THAT(message("b.jpg,9.5"), AllOf(HasSubstr("frames.csv:2"), HasSubstr("does not ascend")));
  EXPECT_THAT(input_error_of([&] { read_frames_csv(folder.path() / "absent.csv"); }), HasSubstr("absent.csv: cannot be read"));
  const auto empty = folder.write("empty.csv", "# filename,timestamp_s\n");
  EXPECT_THAT(input_error_of([&] { read_frames_csv(empty); }), HasSubstr("empty.csv: lists no images"));
}

}  // namespace
}  // namespace fabloop
