// Models survive the file, and a file that was touched anywhere is refused.
#include "services/recognition/files/model_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/base/random.hpp"
#include "tests/unit/recognition/fixture.hpp"

namespace prehend::recognition {
namespace {

const ObjectModels& small() {
  static const ObjectModels made = [] {
    std::vector<TrainingClass> classes;
    for (std::size_t i = 0; i < 3; ++i)
      classes.push_back({catalogue().objects()[i].name,
                         training_views(renderer(), catalogue().objects()[i], {}, 3, 2)});
    DescriptorOptions options;
    options.colours = 12;
    options.coarse_colours = 6;
    return *train(classes, options);
  }();
  return made;
}

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::temp_directory_path() / (name + std::to_string(getpid()));
}

TEST(ModelFile, ComesBackAsItWas) {
  const auto file = temporary("objects-a");
  ASSERT_TRUE(save_models(file, small()));
  const auto loaded = load_models(file);
  std::filesystem::remove(file);
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(to_bytes(*loaded), to_bytes(small()));
}

TEST(ModelFile, EveryFlippedBitIsRefused) {
  const auto file = temporary("objects-b");
  ASSERT_TRUE(save_models(file, small()));
  std::ifstream in(file, std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(in), {}};
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    std::string bad = good;
    const std::size_t place = i < 60 ? static_cast<std::size_t>(i) : random.index(bad.size());
    bad[place] = static_cast<char>(bad[place] ^ (1 << random.index(8)));
    std::ofstream(file, std::ios::binary) << bad;
    EXPECT_FALSE(load_models(file)) << "byte " << place;
  }
  for (const std::size_t length : {std::size_t{0}, std::size_t{10}, good.size() / 2}) {
    std::ofstream(file, std::ios::binary) << good.substr(0, length);
    EXPECT_FALSE(load_models(file));
  }
  std::filesystem::remove(file);
  EXPECT_FALSE(load_models(file));
}

// Behind the seal the contents are still checked: these bytes reach the parser.
TEST(ModelFile, MutatedContentsNeverCrash) {
  const std::string good = to_bytes(small());
  Random random(2);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string bad = good;
    for (std::size_t k = 0; k <= random.index(4); ++k)
      bad[random.index(i % 2 == 0 ? std::min<std::size_t>(400, bad.size()) : bad.size())] =
          static_cast<char>(random.bits());
    const auto models = from_bytes(bad);
    if (models) {
      EXPECT_TRUE(models->check());
    } else {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace prehend::recognition
