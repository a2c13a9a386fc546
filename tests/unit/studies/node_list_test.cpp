#include "studies/run/trace/node_list.h"

#include <gtest/gtest.h>

#include "sim/error.h"

namespace marti::studies {

using namespace run;

namespace {

using Nodes = std::vector<std::uint32_t>;

TEST(NodeLists, HoldNumbersAndRanges) {
  EXPECT_EQ(parse_nodes("", 3), (Nodes{0, 1, 2}));
  EXPECT_EQ(parse_nodes("5", 6), (Nodes{5}));
  EXPECT_EQ(parse_nodes("0-3", 16), (Nodes{0, 1, 2, 3}));
  EXPECT_EQ(parse_nodes("8-9,2,0,2-2", 16), (Nodes{0, 2, 8, 9}));
  for (const char* const text : {"0", "0-3", "1,3,5-7", "0-1,14-15"}) {
    EXPECT_EQ(text_of_nodes(parse_nodes(text, 16)), text);
  }
}

TEST(NodeLists, SayWhatIsWrong) {
  for (const char* wrong :
       {"a", "1,", ",1", "-", "1-", "-1", "3-1", "16", "0-16", "1 2", "0x1", "99999999999", "1-2-3"}) {
    EXPECT_THROW((void)parse_nodes(wrong, 16), sim::UserError) << wrong;
  }
}

}  // namespace
}  // namespace marti::studies
