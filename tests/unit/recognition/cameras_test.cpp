// Cameras that stop, stall, change their pictures or send odd ones: an error that says so, and
// pictures again when there are any. The stream is a real one, over HTTP from a socket of this
// test.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <thread>

#include "services/recognition/cameras/camera.hpp"
#include "services/recognition/cameras/frame.hpp"
#include "services/recognition/files/picture_file.hpp"
#include "tests/unit/recognition/fixture.hpp"

namespace prehend::recognition {
namespace {

Picture plain(int width, int height, std::uint8_t level) {
  Picture made(width, height);
  std::fill(made.rgb.begin(), made.rgb.end(), level);
  return made;
}

/// Sends jpegs to whoever connects, as network cameras do, a few to each, and hangs up.
class NetworkCamera {
 public:
  explicit NetworkCamera(std::vector<std::vector<Picture>> visits) : visits_(std::move(visits)) {
    socket_ = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    ::listen(socket_, 4);
    socklen_t size = sizeof address;
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this] { serve(); });
  }
  ~NetworkCamera() {
    ::shutdown(socket_, SHUT_RDWR);
    ::close(socket_);
  }
  std::string address() const { return "http://127.0.0.1:" + std::to_string(port_) + "/video"; }

 private:
  void serve() {
    for (const auto& pictures : visits_) {
      const int guest = ::accept(socket_, nullptr, nullptr);
      if (guest < 0) return;
      char request[2048];
      if (::read(guest, request, sizeof request) > 0) {
        std::string answer =
            "HTTP/1.0 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=frame\r\n\r\n";
        for (const Picture& picture : pictures) {
          const auto jpeg = encode_jpeg(picture);
          answer += "--frame\r\nContent-Type: image/jpeg\r\nContent-Length: " +
                    std::to_string(jpeg.size()) + "\r\n\r\n";
          answer.append(jpeg.begin(), jpeg.end());
          answer += "\r\n";
        }
        for (std::size_t sent = 0; sent < answer.size();) {
          const auto n = ::send(guest, answer.data() + sent, answer.size() - sent, MSG_NOSIGNAL);
          if (n <= 0) break;
          sent += static_cast<std::size_t>(n);
        }
      }
      ::shutdown(guest, SHUT_WR);
      while (::read(guest, request, sizeof request) > 0) {
      }
      ::close(guest);
    }
  }

  std::vector<std::vector<Picture>> visits_;
  int socket_ = -1, port_ = 0;
  std::jthread thread_;
};

TEST(Cameras, StreamThatHangsUpIsOpenedAnew) {
  const NetworkCamera server(
      {std::vector<Picture>(6, plain(64, 48, 50)), std::vector<Picture>(6, plain(64, 48, 200))});
  CameraOptions options;
  options.source = "video";
  options.path = server.address();
  auto camera = open_camera(options, catalogue(), nullptr);
  ASSERT_TRUE(camera) << camera.error().message();
  EXPECT_TRUE((*camera)->paces_itself());
  int before = 0, errors = 0, after = 0;
  for (int i = 0; i < 40 && after == 0; ++i) {
    const auto picture = (*camera)->next();
    EXPECT_FALSE((*camera)->finished());  // a stream may always come back
    if (!picture)
      ++errors;
    else
      ++(picture->at(30, 20)[0] < 128 ? before : after);
  }
  EXPECT_GT(before, 0);
  EXPECT_GT(errors, 0);
  EXPECT_GT(after, 0);
}

// OpenCV's capture went on handing over the last picture that had the first size.
TEST(Cameras, StreamMayChangeItsSize) {
  std::vector<Picture> pictures;
  const std::vector<std::array<int, 3>> sizes{
      {64, 48, 50}, {128, 96, 100}, {48, 36, 150}, {64, 48, 200}};
  for (const auto& [width, height, level] : sizes)
    pictures.insert(pictures.end(), 4, plain(width, height, static_cast<std::uint8_t>(level)));
  const NetworkCamera server({pictures});
  CameraOptions options;
  options.source = "video";
  options.path = server.address();
  auto camera = open_camera(options, catalogue(), nullptr);
  ASSERT_TRUE(camera) << camera.error().message();
  for (const auto& [width, height, level] : sizes)
    for (int i = 0; i < 4; ++i) {
      const auto picture = (*camera)->next();
      ASSERT_TRUE(picture) << picture.error().message();
      EXPECT_EQ(picture->width, width);
      EXPECT_EQ(picture->height, height);
      for (const auto value : picture->rgb) ASSERT_NEAR(value, level, 3);  // jpeg
    }
}

TEST(Cameras, FramesOfEveryDepthBecomePictures) {
  cv::Mat grey(20, 30, CV_8UC1, cv::Scalar(77));
  EXPECT_EQ(to_picture(grey, "test")->at(3, 3)[2], 77);
  cv::Mat deep(20, 30, CV_16UC1, cv::Scalar(77 * 256));
  EXPECT_EQ(to_picture(deep, "test")->at(3, 3)[1], 77);
  cv::Mat deep_colour(20, 30, CV_16UC3, cv::Scalar(10 * 256, 20 * 256, 30 * 256));
  const auto colour = to_picture(deep_colour, "test");
  ASSERT_TRUE(colour);
  EXPECT_EQ(colour->at(0, 0)[0], 30);  // BGR to RGB
  EXPECT_EQ(colour->at(0, 0)[2], 10);
  EXPECT_TRUE(to_picture(cv::Mat(20, 30, CV_8UC4, cv::Scalar(1, 2, 3, 4)), "test"));
  EXPECT_FALSE(to_picture(cv::Mat(20, 30, CV_32FC3, cv::Scalar(0, 0, 0)), "test"));
  EXPECT_FALSE(to_picture(cv::Mat(20, 30, CV_8UC2, cv::Scalar(0, 0)), "test"));
  EXPECT_FALSE(to_picture(cv::Mat(4, 4, CV_8UC3, cv::Scalar(0, 0, 0)), "test"));
  EXPECT_FALSE(to_picture(cv::Mat(), "test"));
  const auto huge = to_picture(cv::Mat(8, 5'100'000, CV_8UC1, cv::Scalar(0)), "test");
  ASSERT_FALSE(huge);
  EXPECT_EQ(huge.error().message(),
            "test: gives a picture of more than 40 million pixels (choose a smaller format)");
}

TEST(Cameras, FileIsPlayedAtTheRateThatIsAsked) {
  const auto file =
      std::filesystem::temp_directory_path() / ("film" + std::to_string(getpid()) + ".avi");
  {
    cv::VideoWriter film(file.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 30, {64, 48});
    if (!film.isOpened()) GTEST_SKIP() << "OpenCV writes no avi here";
    for (int i = 0; i < 60; ++i) film.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(4 * i)));
  }
  CameraOptions options;
  options.source = "video";
  options.path = file.string();
  for (const auto& [rate, expected] :
       {std::pair(10.0, 20), std::pair(20.0, 40), std::pair(30.0, 60), std::pair(100.0, 60)}) {
    options.rate = rate;
    auto camera = open_camera(options, catalogue(), nullptr);
    ASSERT_TRUE(camera);
    int pictures = 0, last = -1;
    while (!(*camera)->finished() && pictures < 1000) {
      const auto picture = (*camera)->next();
      if (!picture) continue;
      EXPECT_GT(picture->at(30, 20)[0] + 3, last);  // in their order; jpeg moves a level or two
      last = picture->at(30, 20)[0];
      ++pictures;
    }
    EXPECT_NEAR(pictures, expected, 1) << rate;
  }
  std::filesystem::remove(file);
}

// A telephone that was held upright films lying down, and says so in the file.
TEST(Cameras, FilmThatLiesOnItsSideIsTurnedUpright) {
  const auto file =
      std::filesystem::temp_directory_path() / ("lying" + std::to_string(getpid()) + ".mp4");
  {
    cv::VideoWriter film(file.string(), cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 30, {96, 64});
    if (!film.isOpened()) GTEST_SKIP() << "OpenCV writes no mp4 here";
    cv::Mat image(64, 96, CV_8UC3, cv::Scalar::all(40));
    image.colRange(0, 32) = cv::Scalar::all(220);  // what lies left shall be above
    for (int i = 0; i < 5; ++i) film.write(image);
  }
  std::string bytes;
  {
    std::ifstream stream(file, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(stream), {});
  }
  // ISO 14496-12: the matrix stands 40 bytes after the name of the track header.
  const auto header = bytes.find("tkhd");
  ASSERT_NE(header, std::string::npos);
  const auto write = [&](std::size_t element, std::array<unsigned char, 4> value) {
    std::copy(value.begin(), value.end(),
              bytes.begin() + static_cast<std::ptrdiff_t>(header + 44 + 4 * element));
  };
  write(0, {0, 0, 0, 0});
  write(1, {0, 1, 0, 0});  // 1 in 16.16
  write(3, {0xff, 0xff, 0, 0});
  write(4, {0, 0, 0, 0});
  std::ofstream(file, std::ios::binary) << bytes;
  CameraOptions options;
  options.source = "video";
  options.path = file.string();
  auto camera = open_camera(options, catalogue(), nullptr);
  ASSERT_TRUE(camera) << camera.error().message();
  const auto picture = (*camera)->next();
  ASSERT_TRUE(picture) << picture.error().message();
  EXPECT_EQ(picture->width, 64);
  EXPECT_EQ(picture->height, 96);
  EXPECT_NEAR(picture->at(32, 10)[0], 220, 12);
  EXPECT_NEAR(picture->at(32, 80)[0], 40, 12);
  std::filesystem::remove(file);
}

TEST(Cameras, FolderOfPicturesOfManySizesGoesOn) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("cameras" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  ASSERT_TRUE(save_png(folder / "a.png", plain(640, 480, 90)));
  ASSERT_TRUE(save_png(folder / "b.png", plain(320, 240, 90)));
  const auto jpeg = encode_jpeg(plain(100, 80, 90));
  std::ofstream(folder / "c.jpg", std::ios::binary)
      .write(reinterpret_cast<const char*>(jpeg.data()), 300);  // truncated
  ASSERT_TRUE(save_png(folder / "d.png", plain(4, 4, 90)));     // tiny
  CameraOptions options;
  options.source = "folder";
  options.path = folder.string();
  auto camera = open_camera(options, catalogue(), nullptr);
  ASSERT_TRUE(camera);
  for (int round = 0; round < 2; ++round) {
    EXPECT_EQ((*camera)->next()->width, 640);
    EXPECT_EQ((*camera)->next()->width, 320);
    (*camera)->next();  // half a jpeg may be shown as far as it goes, or refused
    EXPECT_FALSE((*camera)->next());
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace prehend::recognition
