// Pictures of every kind become 8-bit RGB or a clear error.
#include "services/recognition/files/picture_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/base/random.hpp"
#include "services/recognition/cameras/camera.hpp"
#include "services/recognition/files/dataset.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/unit/recognition/fixture.hpp"

namespace prehend::recognition {
namespace {

class PictureFile : public ::testing::Test {
 protected:
  PictureFile() { std::filesystem::create_directories(folder_); }
  ~PictureFile() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("pictures" + std::to_string(getpid()));
};

Picture gradient(int width, int height) {
  Picture made(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      made.at(x, y)[0] = static_cast<std::uint8_t>(255 * x / width);
      made.at(x, y)[1] = static_cast<std::uint8_t>(255 * y / height);
      made.at(x, y)[2] = 40;
    }
  return made;
}

TEST_F(PictureFile, PngComesBackExactlyAndJpegNearly) {
  const Picture picture = gradient(60, 40);
  ASSERT_TRUE(save_png(folder_ / "a.png", picture));
  EXPECT_EQ(load_picture(folder_ / "a.png")->rgb, picture.rgb);
  const auto bytes = encode_jpeg(picture, 95);
  const auto back = decode_picture(bytes, "memory");
  ASSERT_TRUE(back);
  double difference = 0;
  for (std::size_t i = 0; i < back->rgb.size(); ++i)
    difference += std::abs(int(back->rgb[i]) - int(picture.rgb[i]));
  EXPECT_LT(difference / static_cast<double>(back->rgb.size()), 6);  // chroma is subsampled
}

TEST_F(PictureFile, GreyAndSixteenBitAreRead) {
  // Binary PGM and PPM, which need no encoder: grey 8 bit, colour 16 bit.
  std::ofstream(folder_ / "g.bmp", std::ios::binary) << "P5 16 16 255\n"
                                                     << std::string(256, '\x50');
  const auto grey = load_picture(folder_ / "g.bmp");  // the contents count, not the name
  ASSERT_TRUE(grey);
  EXPECT_EQ(grey->at(3, 3)[0], 0x50);
  EXPECT_EQ(grey->at(3, 3)[2], 0x50);
  std::ofstream(folder_ / "s.ppm", std::ios::binary) << "P6 16 16 65535\n"
                                                     << std::string(16 * 16 * 6, '\x40');
  const auto deep = load_picture(folder_ / "s.ppm");
  ASSERT_TRUE(deep);
  EXPECT_NEAR(deep->at(0, 0)[1], 0x40, 1);
}

TEST_F(PictureFile, TruncatedAndBrokenFilesNeverCrash) {
  const auto bytes = encode_jpeg(gradient(80, 60));
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    auto bad = bytes;
    if (i % 2 == 0) bad.resize(random.index(bad.size()));
    for (int k = 0; k < 5 && !bad.empty(); ++k)
      bad[random.index(bad.size())] = static_cast<std::uint8_t>(random.bits());
    const auto picture = decode_picture(bad, "memory");
    if (picture) {
      EXPECT_EQ(picture->rgb.size(), 3 * picture->pixels());
    }
  }
  EXPECT_FALSE(decode_picture({}, "memory"));
  EXPECT_FALSE(load_picture(folder_ / "absent.png"));
  EXPECT_FALSE(load_picture(folder_));
}

// A jpeg that was copied in part was read, and learnt, with grey in place of the rest.
TEST_F(PictureFile, AJpegThatEndsEarlyIsRefused) {
  const auto whole = encode_jpeg(gradient(80, 60));
  for (const double share : {0.3, 0.6, 0.9}) {
    const auto size = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
    const auto cut = decode_picture({whole.data(), size}, "memory");
    ASSERT_FALSE(cut) << share;
    EXPECT_NE(cut.error().what.find("early"), std::string::npos) << cut.error().message();
  }
  auto more = whole;
  more.resize(more.size() + 100, 0);  // what cameras may add behind the end
  EXPECT_TRUE(decode_picture(more, "memory"));
}

/// The same jpeg with a turn of 1 to 8 in an EXIF tag, as phones write it.
std::vector<std::uint8_t> turned(std::vector<std::uint8_t> jpeg, std::uint8_t turn) {
  const std::vector<std::uint8_t> tag{0xff, 0xe1, 0,    34,   'E', 'x', 'i', 'f', 0, 0,  // APP1
                                      'M',  'M',  0,    0x2a, 0,   0,   0,   8,  // TIFF, big endian
                                      0,    1,    0x01, 0x12, 0,   3,   0,   0,   0, 1,
                                      0,    turn, 0,    0,    0,   0,   0,   0};  // one entry
  jpeg.insert(jpeg.begin() + 2, tag.begin(), tag.end());
  return jpeg;
}

// Guards pixels as geometry: a camera was placed 180° wrong since its pictures were turned.
TEST_F(PictureFile, PixelsStayWhereTheyAreStored) {
  const auto bytes = encode_jpeg(gradient(80, 60));
  const Picture stored = decode_picture(bytes, "memory").value();
  for (std::uint8_t turn = 1; turn <= 8; ++turn) {
    const auto picture = decode_picture(turned(bytes, turn), "memory");
    ASSERT_TRUE(picture) << picture.error().message();
    EXPECT_EQ(picture->width, 80) << int(turn);
    EXPECT_EQ(picture->rgb, stored.rgb) << int(turn);
  }
}

// A mask lies over the pixels of its picture, whatever the picture's tag says.
TEST_F(PictureFile, AMaskLiesOverAPictureThatIsTaggedAsTurned) {
  const auto bytes = turned(encode_jpeg(gradient(80, 60)), 3);
  std::ofstream(folder_ / "a.jpg", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  Plane mask(80, 60);
  mask.at(70, 50) = 1;  // there green and red are bright; turned by half, they are dark
  ASSERT_TRUE(save_png(folder_ / "a.mask.png", mask));
  const auto view = load_view(folder_ / "a.jpg");
  ASSERT_TRUE(view) << view.error().message();
  EXPECT_EQ(view->mask.at(70, 50), 1);
  EXPECT_GT(int(view->picture.at(70, 50)[0]), 200);
  // Drawn over the turned picture it does not fit; that is said with both sizes.
  ASSERT_TRUE(save_png(folder_ / "a.mask.png", Plane(60, 80)));
  const auto refused = load_view(folder_ / "a.jpg");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("60x80"), std::string::npos);
  EXPECT_NE(refused.error().message().find("EXIF"), std::string::npos);
}

TEST_F(PictureFile, NamesCountInNaturalOrder) {
  for (const char* name : {"shot10.png", "shot2.png", "shot1.png", "shot2.mask.png"})
    ASSERT_TRUE(save_png(folder_ / name, gradient(16, 16)));
  std::vector<std::string> names;
  for (const auto& file : pictures_in(folder_)) names.push_back(file.filename());
  EXPECT_EQ(names, (std::vector<std::string>{"shot1.png", "shot2.png", "shot10.png"}));
}

TEST_F(PictureFile, HugeOnesAreRefusedBeforeTheyAreUnpacked) {
  std::vector<std::uint8_t> png{0x89, 'P', 'N',  'G',  13,  10,  26, 10, 0,    0,
                                0,    13,  'I',  'H',  'D', 'R', 0,  1,  0x86, 0xa0,
                                0,    1,   0x86, 0xa0, 8,   2,   0,  0,  0};  // 100000²
  const auto refused = decode_picture(png, "memory");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("40 million"), std::string::npos);
  ASSERT_TRUE(save_png(folder_ / "tiny.png", gradient(4, 4)));
  EXPECT_FALSE(load_picture(folder_ / "tiny.png"));
  // A kind whose header is not looked at, with a bit a pixel; and a file that is no picture at all.
  std::ofstream(folder_ / "wide.pbm", std::ios::binary) << "P4 8000 5001\n"
                                                        << std::string(5001000, 0);
  std::ofstream(folder_ / "huge.png") << "x";
  std::filesystem::resize_file(folder_ / "huge.png", 257'000'000);  // with holes
  for (const auto& [name, says] :
       {std::pair("wide.pbm", ": has more than 40 million pixels (make it smaller)"),
        std::pair("huge.png", ": is too large for a picture (more than 256 MB)")})
    EXPECT_EQ(load_picture(folder_ / name).error().message(), (folder_ / name).string() + says);
}

TEST_F(PictureFile, WhereNothingCanBeWrittenIsSaid) {
  for (const auto& written : {save_png("/nowhere/a.png", gradient(16, 16)),
                              save_jpeg("/nowhere/a.png", gradient(16, 16))}) {
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().message(),
              "/nowhere/a.png: cannot be written (is the folder there and writable?)");
  }
}

TEST_F(PictureFile, ShrinkKeepsTheRatioAndNeverGrows) {
  const Picture small = shrink(gradient(400, 300), 200);
  EXPECT_EQ(small.width, 200);
  EXPECT_EQ(small.height, 150);
  EXPECT_EQ(shrink(gradient(30, 20), 200).width, 30);
}

TEST_F(PictureFile, FolderCameraGoesOnAfterAnUnreadablePicture) {
  ASSERT_TRUE(save_png(folder_ / "a.png", gradient(32, 32)));
  std::ofstream(folder_ / "b.jpg") << "no picture";
  CameraOptions options;
  options.source = "folder";
  options.path = folder_.string();
  auto camera = open_camera(options, catalogue(), nullptr);
  ASSERT_TRUE(camera);
  EXPECT_TRUE((*camera)->next());
  EXPECT_FALSE((*camera)->next());
  EXPECT_TRUE((*camera)->next());  // the first again
}

TEST_F(PictureFile, MissingCamerasAreErrors) {
  CameraOptions options;
  for (const auto& [source, path] :
       {std::pair("device", "/dev/video_absent"), std::pair("video", "/absent.mp4"),
        std::pair("folder", "/absent"), std::pair("synthetic", ""), std::pair("nonsense", "")}) {
    options.source = source;
    options.path = path;
    EXPECT_FALSE(open_camera(options, catalogue(), nullptr)) << source;
  }
  options.source = topic_camera().name;
  EXPECT_EQ(open_camera(options, catalogue(), nullptr).error().message(),
            "recognition.source: there is nothing to open (its pictures come by topic)");
}

TEST_F(PictureFile, VideoOfAHandPlaysToItsEnd) {
  const auto file = shared_data() / "landmark_hand_recording" / "human_hand_video.mp4";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  CameraOptions options;
  options.source = "video";
  options.path = file.string();
  auto camera = open_camera(options, catalogue(), nullptr);
  ASSERT_TRUE(camera) << camera.error().message();
  int pictures = 0;
  while (!(*camera)->finished() && pictures < 100000) pictures += (*camera)->next().has_value();
  EXPECT_GT(pictures, 100);
  EXPECT_LT(pictures, 100000);
}

}  // namespace
}  // namespace prehend::recognition
