// What is put into a page stays what it is: nothing of it becomes an element or ends an attribute.
#include "common/base/html.hpp"

#include <gtest/gtest.h>

#include "common/base/base64.hpp"

namespace prehend {
namespace {

TEST(Html, TextOfOthersBecomesNoElementAndEndsNoAttribute) {
  EXPECT_EQ(html_escaped("Uncle Ben's, 40 mm"), "Uncle Ben's, 40 mm");
  EXPECT_EQ(html_escaped("<b class=\"x\">&</b>"), "&lt;b class=&quot;x&quot;&gt;&amp;&lt;/b&gt;");
}

TEST(Base64, IsThatOfTheStandard) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

}  // namespace
}  // namespace prehend
