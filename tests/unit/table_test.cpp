#include "graspd/formats/table.hpp"

#include <gtest/gtest.h>

namespace graspd {
namespace {

TEST(Table, AlignsTextLeftAndNumbersRight) {
  Table table({"part", "grasps", "µm"});
  table.add({"tee", "7", "1.5"});
  table.add({"straight pipe", "12", "–"});
  EXPECT_EQ(table.to_text(),
            "part           grasps   µm\n"
            "──────────────────────────\n"
            "tee                 7  1.5\n"
            "straight pipe      12    –\n");
}

TEST(Table, WritesMarkdownAndCsv) {
  Table table({"name", "value"});
  table.add({"a, \"quoted\"", "1"});
  EXPECT_EQ(table.to_markdown(), "| name | value |\n|---|---:|\n| a, \"quoted\" | 1 |\n");
  EXPECT_EQ(table.to_csv(), "name,value\n\"a, \"\"quoted\"\"\",1\n");
}

TEST(Table, WithoutRowsIsItsHeader) { EXPECT_EQ(Table({"a", "b"}).to_text(), "a  b\n────\n"); }

}  // namespace
}  // namespace graspd
