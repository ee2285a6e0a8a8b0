// Pictures of a recording, decoded without OpenCV, are those that OpenCV decodes; what cannot be
// decoded does not spoil the next one.
#include "services/recorder/tools/dataset/pictures.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/recording/compare/recorded_topic.hpp"
#include "common/recording/mcap/reader.hpp"
#include "services/recorder/tools/dataset/message.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::recorder::dataset {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The first picture of a sample.
Bytes recorded() {
  auto reader =
      recording::mcap::Reader::open(test::in_sources("deploy/samples/intelligent-grasp.mcap"))
          .value();
  recording::RecordedTypes types(reader);
  auto cursor = reader.messages(
      {.wanted = [](const auto& channel) { return channel.topic == "camera/image"; }});
  const auto next = cursor.next().value().value();
  const auto value = recording::types::decode(*types.of(*next.channel), next.message.data).value();
  return std::get<Value::Bytes>(value.find("data")->content);
}

/// Mean difference of a colour, of 255.
double difference(const Rgb& ours, const cv::Mat& bgr) {
  cv::Mat rgb;
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  double sum = 0;
  for (int y = 0; y < rgb.rows; ++y)
    for (int x = 0; x < 3 * rgb.cols; ++x)
      sum += std::abs(rgb.ptr<std::uint8_t>(y)[x] -
                      ours.bytes[static_cast<std::size_t>(y * 3 * rgb.cols + x)]);
  return sum / static_cast<double>(ours.bytes.size());
}

TEST(Pictures, JpegAndPngAsOpenCvSeesThem) {
  const Bytes jpeg = recorded();
  const cv::Mat expected = cv::imdecode(jpeg, cv::IMREAD_COLOR);
  ASSERT_FALSE(expected.empty());
  const Size size{expected.cols, expected.rows};
  PictureDecoder decoder;
  const auto ours = decoder.decode(jpeg, size);
  ASSERT_TRUE(ours);
  // They spread colours, of which a jpeg has fewer, in different ways.
  EXPECT_LT(difference(*ours, expected), 2.5);

  Bytes png;
  ASSERT_TRUE(cv::imencode(".png", expected, png));
  const auto exact = decoder.decode(png, size);
  ASSERT_TRUE(exact);
  EXPECT_EQ(difference(*exact, expected), 0);
  // The second one was added to the first.
  const auto again = decoder.decode(png, size);
  ASSERT_TRUE(again);
  EXPECT_EQ(difference(*again, expected), 0);
}

TEST(Pictures, OfAnotherSize) {
  const Bytes jpeg = recorded();
  const cv::Mat expected = cv::imdecode(jpeg, cv::IMREAD_COLOR);
  cv::Mat small;
  cv::resize(expected, small, {84, 60}, 0, 0, cv::INTER_AREA);
  PictureDecoder decoder;
  const auto ours = decoder.decode(jpeg, {84, 60});
  ASSERT_TRUE(ours);
  EXPECT_LT(difference(*ours, small), 3);
}

TEST(Pictures, ABrokenOneDoesNotSpoilTheNext) {
  const Bytes jpeg = recorded();
  const cv::Mat expected = cv::imdecode(jpeg, cv::IMREAD_COLOR);
  const Size size{expected.cols, expected.rows};
  PictureDecoder decoder;
  EXPECT_FALSE(decoder.decode({}, size));
  EXPECT_FALSE(decoder.decode(Bytes(100, 7), size));
  EXPECT_FALSE(decoder.decode(Bytes(jpeg.begin(), jpeg.begin() + 20), size));
  const auto ours = decoder.decode(jpeg, size);
  ASSERT_TRUE(ours);
  EXPECT_LT(difference(*ours, expected), 2.5);
}

}  // namespace
}  // namespace prehend::recorder::dataset
