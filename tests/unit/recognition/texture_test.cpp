// Painted faces stay as they are: recognisers that users trained on pictures of them know them.
#include "services/recognition/core/rendering/texture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <array>
#include <map>

#include "tests/unit/recognition/fixture.hpp"

namespace prehend::recognition {
namespace {

/// Light of a face's four quarters, 0 to 1: lower left, lower right, upper left, upper right.
using Quarters = std::array<double, 4>;

Quarters quarters(const Face& face) {
  Quarters sums{}, counts{};
  for (int j = 0; j < face.height; ++j)
    for (int i = 0; i < face.width; ++i) {
      const std::size_t quarter =
          (2 * i >= face.width ? 1U : 0U) + (2 * j >= face.height ? 2U : 0U);
      sums[quarter] += face.at((i + 0.5) / face.width, (j + 0.5) / face.height).mean();
      counts[quarter] += 1;
    }
  for (std::size_t q = 0; q < 4; ++q) sums[q] /= counts[q];
  return sums;
}

/// The first face of each object of the catalogue.
const std::map<std::string, Quarters> known{{"Vitamins", {0.4034, 0.4023, 0.4991, 0.4979}},
                                            {"Talc", {0.5514, 0.5419, 0.5322, 0.5268}},
                                            {"Cup", {0.3903, 0.3892, 0.3245, 0.3240}},
                                            {"Pringles", {0.4904, 0.4935, 0.3029, 0.3015}},
                                            {"Wood cube", {0.3599, 0.2888, 0.3546, 0.2853}},
                                            {"Toy car", {0.2964, 0.2956, 0.3642, 0.3645}},
                                            {"Russini", {0.3875, 0.3906, 0.3295, 0.3274}},
                                            {"Uncle Ben's", {0.3511, 0.3495, 0.4768, 0.4720}},
                                            {"Carton box", {0.2387, 0.2644, 0.3121, 0.3530}}};

TEST(Texture, FacesStayAsTheyWerePainted) {
  for (const auto& object : catalogue().objects()) {
    const Quarters now = quarters(paint(object).faces.at(0));
    EXPECT_TRUE(known.contains(object.name))
        << fmt::format("{{\"{}\", {{{:.4f}}}}},", object.name, fmt::join(now, ", "));
    if (!known.contains(object.name)) continue;
    for (std::size_t q = 0; q < 4; ++q)
      EXPECT_NEAR(now[q], known.at(object.name)[q], 1e-3) << object.name << ", quarter " << q;
  }
}

}  // namespace
}  // namespace prehend::recognition
