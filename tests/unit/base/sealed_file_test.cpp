// Sealed files: every cut and every flipped bit is noticed, another kind is refused by name.
#include "common/proto/sealed_file.hpp"

#include <gtest/gtest.h>

namespace prehend::proto {
namespace {

TEST(SealedFile, EveryDamageIsNoticed) {
  const std::string bytes("some bytes with \0 in them\n and a line", 37);
  const std::string sealed = seal("thing", bytes);
  ASSERT_EQ(unseal(sealed, "thing").value(), bytes);
  for (std::size_t i = 0; i < sealed.size(); ++i) {
    EXPECT_FALSE(unseal(std::string_view(sealed).substr(0, i), "thing")) << "cut at " << i;
    for (int bit = 0; bit < 8; ++bit) {
      std::string flipped = sealed;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << bit));
      EXPECT_FALSE(unseal(flipped, "thing")) << "byte " << i << " bit " << bit;
    }
  }
  EXPECT_FALSE(unseal(sealed + "x", "thing"));
}

TEST(SealedFile, AnotherKindIsRefusedByName) {
  const auto refused = unseal(seal("object-model", "x"), "mapping-model");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("object-model"), std::string::npos);
  EXPECT_NE(refused.error().message().find("mapping-model"), std::string::npos);
}

}  // namespace
}  // namespace prehend::proto
