// Whatever lies in a training folder: an answer, an honest doubt or a reason, never a crash.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>

#include "services/recognition/files/dataset.hpp"
#include "services/recognition/files/picture_file.hpp"
#include "tests/unit/recognition_learning/painted.hpp"

namespace prehend::recognition {
namespace {

class TrainingFolder : public ::testing::Test {
 protected:
  TrainingFolder() {
    static int number = 0;
    root_ = std::filesystem::temp_directory_path() /
            ("objects-folder" + std::to_string(getpid()) + "-" + std::to_string(number++));
    std::filesystem::create_directories(root_);
  }
  ~TrainingFolder() override { std::filesystem::remove_all(root_); }

  std::filesystem::path in(const std::string& name) {
    std::filesystem::create_directories(root_ / name);
    return root_ / name;
  }
  void fill(const std::string& name, const TrainingClass& with) {
    for (std::size_t i = 0; i < with.views.size(); ++i)
      ASSERT_TRUE(save_jpeg(in(name) / (std::to_string(i) + ".jpg"), with.views[i].picture));
  }
  /// Trains and names everything; probabilities must be that.
  void expect_sound() {
    const auto dataset = load_dataset(root_);
    ASSERT_TRUE(dataset) << dataset.error().message();
    for (const DescriptorOptions& options : {DescriptorOptions(), photos_of_objects()}) {
      const auto models = train(dataset->classes, options);
      ASSERT_TRUE(models) << models.error().message();
      EXPECT_TRUE(models->check());
      for (const TrainingClass& c : dataset->classes)
        for (const TrainingView& view : c.views) {
          const Classification seen = named(*models, view);
          EXPECT_TRUE(seen.probability >= 0 && seen.probability <= 1);
          EXPECT_TRUE(seen.scores.allFinite());
        }
    }
  }
  std::filesystem::path root_;
};

TEST_F(TrainingFolder, Empty) {
  EXPECT_FALSE(load_dataset(root_));
  in("nothing");
  EXPECT_FALSE(load_dataset(root_));
  EXPECT_FALSE(load_dataset(root_ / "absent"));
}

TEST_F(TrainingFolder, OnePicture) {
  TrainingClass one = painted_classes(1, 1)[0];
  one.views.resize(1);
  fill("one", one);
  expect_sound();
}

// Nothing tells two classes of the same pictures apart, so no answer may be sure.
TEST_F(TrainingFolder, TwoClassesAlike) {
  const TrainingClass c = painted_classes(5, 1)[0];
  fill("first", c);
  fill("second", c);
  expect_sound();
  const auto dataset = load_dataset(root_);
  const auto models = train(dataset->classes);
  const auto unseen = painted_classes(5, 3);
  for (const TrainingView& view : unseen[0].views) EXPECT_LT(named(*models, view).probability, 0.8);
}

TEST_F(TrainingFolder, GreySixteenBitAnimatedTinyHugeAndTruncated) {
  fill("good", painted_classes(2, 1)[0]);
  const auto odd = in("odd");
  cv::Mat grey(40, 30, CV_8UC1), deep(40, 30, CV_16UC3), tiny(3, 2, CV_8UC3, cv::Scalar(9, 9, 9));
  cv::randu(grey, 0, 255);
  cv::randu(deep, 0, 65535);
  ASSERT_TRUE(cv::imwrite((odd / "grey.png").string(), grey));
  ASSERT_TRUE(cv::imwrite((odd / "deep.png").string(), deep));
  ASSERT_TRUE(cv::imwrite((odd / "deep.tiff").string(), deep));
  ASSERT_TRUE(cv::imwrite((odd / "tiny.png").string(), tiny));
  ASSERT_TRUE(cv::imwrite((odd / "black.png").string(), cv::Mat::zeros(64, 64, CV_8UC3)));
  ASSERT_TRUE(cv::imwrite((odd / "thin.png").string(), cv::Mat::zeros(9, 700, CV_8UC3)));
  // A png that announces 60,000 by 60,000 pixels, a jpeg cut in half, and no picture at all.
  std::ifstream in_png(odd / "grey.png", std::ios::binary);
  std::string huge{std::istreambuf_iterator<char>(in_png), {}};
  for (const std::size_t at : {16u, 20u}) huge.replace(at, 4, std::string("\x00\x00\xea\x60", 4));
  std::ofstream(odd / "huge.png", std::ios::binary) << huge;
  std::ifstream in_jpeg(root_ / "good" / "0.jpg", std::ios::binary);
  const std::string jpeg{std::istreambuf_iterator<char>(in_jpeg), {}};
  std::ofstream(odd / "cut.jpg", std::ios::binary) << jpeg.substr(0, jpeg.size() / 2);
  std::ofstream(odd / "text.jpg") << "not a picture";
  std::ofstream(odd / "empty.jpg");
  // Two frames in one file; the first counts.
  ASSERT_TRUE(cv::imwritemulti((odd / "pages.tiff").string(), std::vector<cv::Mat>{grey, grey}));
  expect_sound();
  const auto dataset = load_dataset(root_);
  EXPECT_GE(dataset->left_out.size(), 4u);  // tiny, huge, text, empty
  for (const Error& error : dataset->left_out) EXPECT_FALSE(error.what.empty());
}

// A class whose pictures lie in folders of their own, or are of a kind that cannot be read, was
// left out without a word.
TEST_F(TrainingFolder, FoldersWithoutPicturesAreTold) {
  fill("good", painted_classes(1, 1)[0]);
  fill("nested/red", painted_classes(1, 1)[0]);
  std::ofstream(in("phone") / "IMG_1.HEIC") << "of a telephone";
  const auto dataset = load_dataset(root_);
  ASSERT_TRUE(dataset) << dataset.error().message();
  ASSERT_EQ(dataset->left_out.size(), 2u);
  EXPECT_NE(dataset->left_out[0].where.find("nested"), std::string::npos);
  EXPECT_NE(dataset->left_out[1].where.find("IMG_1.HEIC"), std::string::npos);
}

TEST_F(TrainingFolder, MaskOfAnotherSizeIsLeftOutWithItsPicture) {
  fill("good", painted_classes(1, 1)[0]);
  ASSERT_TRUE(save_png(in("good") / "0.mask.png", Plane(5, 5, 1)));
  const auto dataset = load_dataset(root_);
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->left_out.size(), 1u);
}

}  // namespace
}  // namespace prehend::recognition
