// Chessboards drawn by the camera's own geometry, so the truth is known: four by four rays a pixel,
// noise of two grey levels, a board held in many places and slants before a lens with distortion.
// Corners are found to about 0.05 px; over 20 views of 54 corners that leaves the focal length
// uncertain by less than 0.5 px of 620, and the tolerances are four times that.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/base/random.hpp"
#include "services/recognition/files/picture_file.hpp"
#include "services/recognition/tools/calibration/board_taker.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/unit/recognition/fixture.hpp"

namespace prehend::recognition {
namespace {

using std::numbers::pi;
const Chessboard board;

CameraModel true_camera() {
  CameraModel camera = lab_camera();
  camera.focal = {605, 611};
  camera.centre = {325, 236};
  camera.distortion = {-0.12, 0.05, 0.001, -0.0008, 0};
  return camera;
}

/// The board with a white rim of one square on grey, in X_WB.
Picture draw(const CameraModel& camera, const Pose& X_WB, std::uint64_t seed) {
  Picture picture(camera.width, camera.height);
  const Pose X_BW = X_WB.inverse();
  const Eigen::Vector3d eye = X_BW * camera.X_WC.translation();
  constexpr int side = 4;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      double sum = 0;
      // One undistortion a pixel; within it the ray moves evenly.
      const Eigen::Vector3d middle = X_BW.linear() * camera.ray({double(x), double(y)});
      const Eigen::Vector3d right = X_BW.linear() * camera.ray({x + 1.0, double(y)}) - middle;
      const Eigen::Vector3d down = X_BW.linear() * camera.ray({double(x), y + 1.0}) - middle;
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
          const Eigen::Vector3d d =
              middle + ((i + 0.5) / side - 0.5) * right + ((j + 0.5) / side - 0.5) * down;
          const double t = -eye.z() / d.z();
          const Eigen::Vector3d p = (eye + t * d) / board.square;
          const int column = static_cast<int>(std::floor(p.x())) + 1;  // of squares
          const int row = static_cast<int>(std::floor(p.y())) + 1;
          const bool inside =
              t > 0 && column >= 0 && row >= 0 && column <= board.columns && row <= board.rows;
          const bool rim = t > 0 && column >= -1 && row >= -1 && column <= board.columns + 1 &&
                           row <= board.rows + 1;
          sum += inside ? ((column + row) % 2 == 0 ? 25 : 225) : rim ? 225 : 120;
        }
      std::fill_n(picture.at(x, y), 3, static_cast<std::uint8_t>(sum / (side * side)));
    }
  Renderer::add_noise(picture, 2, seed);
  return picture;
}

Pose lying(double x, double y, double yaw) {
  return make_pose({x, y, 0}, (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(pi, Eigen::Vector3d::UnitX()))
                                  .toRotationMatrix());
}

/// Held up to the camera, slanted.
Pose held(const CameraModel& camera, Random& random) {
  const double distance = random.uniform(0.35, 0.6);
  const Eigen::Vector3d middle_C(random.uniform(-0.28, 0.28) * distance,
                                 random.uniform(-0.2, 0.2) * distance, distance);
  const Eigen::Matrix3d R_CB =
      (Eigen::AngleAxisd(random.uniform(-0.6, 0.6), Eigen::Vector3d::UnitX()) *
       Eigen::AngleAxisd(random.uniform(-0.6, 0.6), Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(random.uniform(-0.4, 0.4), Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const Eigen::Vector3d middle_B(4 * board.square, 2.5 * board.square, 0);
  return camera.X_WC * make_pose(middle_C - R_CB * middle_B, R_CB);
}

double turn_between(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

TEST(Chessboard, CornersAreFoundInTheirOrderHoweverTheBoardIsTurned) {
  const CameraModel camera = true_camera();
  for (const double yaw : {0.0, 1.2, 2.6, pi, -2.0, -0.7}) {
    const Pose X_WB = lying(0.02 - 0.1 * std::cos(yaw), 0.03 - 0.1 * std::sin(yaw), yaw);
    const auto view = find_chessboard(draw(camera, X_WB, 1), board);
    ASSERT_TRUE(view) << yaw;
    double worst = 0;
    for (int k = 0; k < board.columns * board.rows; ++k) {
      const Eigen::Vector3d p_B(k % board.columns * board.square, k / board.columns * board.square,
                                0);
      const auto expected = camera.project(X_WB * p_B);
      worst = std::max(worst, ((*view)[static_cast<std::size_t>(k)] - *expected).norm());
    }
    EXPECT_LT(worst, 0.3) << yaw;
  }
}

TEST(Chessboard, BoardsThatLookTheSameUpsideDownAreRefused) {
  EXPECT_TRUE(checked_board({9, 6, 0.025}));
  EXPECT_FALSE(checked_board({8, 6, 0.025}));
  EXPECT_FALSE(checked_board({9, 7, 0.025}));
  EXPECT_FALSE(checked_board({2, 3, 0.025}));
  EXPECT_FALSE(checked_board({9, 6, 0}));
  EXPECT_FALSE(checked_board({9, 6, std::nan("")}));
}

TEST(Chessboard, NoneInPicturesWithoutOne) {
  EXPECT_FALSE(find_chessboard(Picture(640, 480), board));
  EXPECT_FALSE(find_chessboard(Picture(8, 8), board));
  EXPECT_FALSE(find_chessboard(Picture(), board));
  const model::Scene scene = *model::make_scene(catalogue(), 4, {});
  EXPECT_FALSE(find_chessboard(renderer().render(scene, lab_camera()), board));
}

/// Sixteen pictures; in the first the board lies on the table.
const std::vector<Picture>& shots() {
  static const std::vector<Picture> made = [] {
    Random random(2);
    std::vector<Picture> all{draw(true_camera(), lying(-0.1, 0.05, 0.3), 0)};
    for (std::uint64_t i = 1; i < 16; ++i)
      all.push_back(draw(true_camera(), held(true_camera(), random), i));
    return all;
  }();
  return made;
}

TEST(Calibration, FindsLensAndPlaceOfTheCameraThatDrewTheBoards) {
  const CameraModel truth = true_camera();
  std::vector<BoardView> views;
  for (const Picture& picture : shots())
    if (const auto view = find_chessboard(picture, board)) views.push_back(*view);
  ASSERT_GE(views.size(), 12u);
  const auto made = calibrate(views, board, truth.width, truth.height);
  ASSERT_TRUE(made) << made.error().message();
  EXPECT_LT(made->residual, 0.15);
  EXPECT_LT((made->camera.focal - truth.focal).norm(), 3);
  EXPECT_LT((made->camera.centre - truth.centre).norm(), 3);
  // Within what the calibration itself says of its accuracy.
  EXPECT_LT((made->camera.focal - truth.focal).cwiseAbs().maxCoeff(),
            5 * made->focal_sigma.maxCoeff());
  const auto place = locate_camera(made->camera, views.front(), board, {-0.1, 0.05, 0.3});
  ASSERT_TRUE(place) << place.error().message();
  EXPECT_LT((place->X_WC.translation() - truth.X_WC.translation()).norm(), 0.005);
  EXPECT_LT(turn_between(place->X_WC, truth.X_WC), 0.3 * pi / 180);
  EXPECT_LT(place->on_table, 0.0005);
  // What it is for: where pixels lie on the table.
  CameraModel found = made->camera;
  found.X_WC = place->X_WC;
  for (const double x : {-0.3, 0.0, 0.3})
    for (const double y : {-0.2, 0.1, 0.3}) {
      const Eigen::Vector3d p(x, y, 0);
      EXPECT_LT((*found.on_level(*truth.project(p), 0) - p).norm(), 0.003) << x << " " << y;
    }
}

/// The board's corners, with that much noise, px.
BoardView seen(const CameraModel& camera, const Pose& X_WB, double noise, Random& random) {
  BoardView view;
  for (int k = 0; k < board.columns * board.rows; ++k)
    view.push_back(*camera.project(X_WB * Eigen::Vector3d(k % board.columns * board.square,
                                                          k / board.columns * board.square, 0)) +
                   Eigen::Vector2d(random.normal(noise), random.normal(noise)));
  return view;
}

TEST(Calibration, AViewThatFitsNotIsLeftOut) {
  const CameraModel truth = true_camera();
  Random random(3);
  std::vector<BoardView> views;
  for (int i = 0; i < 9; ++i) {
    const Pose X_WB = held(truth, random);
    views.push_back(seen(truth, X_WB, 0.05, random));
  }
  for (std::size_t k = 0; k < views[4].size(); ++k) views[4][k].x() += k % 3 == 0 ? 6 : -4;
  const auto made = calibrate(views, board, truth.width, truth.height);
  ASSERT_TRUE(made);
  EXPECT_LT(made->errors[4], 0);
  EXPECT_EQ(std::count_if(made->errors.begin(), made->errors.end(), [](double e) { return e < 0; }),
            1);
  EXPECT_LT((made->camera.focal - truth.focal).norm(), 3);
}

TEST(Calibration, ViewsThatDetermineNothingAreRefused) {
  const CameraModel truth = true_camera();
  Random random(4);
  BoardView view;
  const Pose X_WB = held(truth, random);
  for (int k = 0; k < board.columns * board.rows; ++k)
    view.push_back(*truth.project(X_WB * Eigen::Vector3d(k % board.columns * board.square,
                                                         k / board.columns * board.square, 0)));
  EXPECT_FALSE(calibrate({}, board, 640, 480));
  EXPECT_FALSE(calibrate({view, view, view, view}, board, 640, 480));
  EXPECT_FALSE(calibrate(std::vector<BoardView>(8, BoardView(3)), board, 640, 480));
  const std::vector<BoardView> flat(8, BoardView(54, Eigen::Vector2d(100, 100)));
  EXPECT_FALSE(calibrate(flat, board, 640, 480));
  EXPECT_FALSE(locate_camera(truth, flat.front(), board, {}));
  EXPECT_FALSE(locate_camera(truth, {}, board, {}));
}

// It looks the same from near as through a longer lens.
TEST(Calibration, ABoardThatIsHardlySlantedLeavesTheFocalLengthOpen) {
  const CameraModel truth = true_camera();
  Random random(5);
  std::vector<std::string> refusals;
  for (const double slant : {0.03, 0.06, 0.1})
    for (const double noise : {0.5, 1.0, 2.0}) {
      std::vector<BoardView> views;
      for (int i = 0; i < 6; ++i) {
        const Eigen::Matrix3d R_CB(
            Eigen::AngleAxisd(random.uniform(-slant, slant), Eigen::Vector3d::UnitX()) *
            Eigen::AngleAxisd(random.uniform(-slant, slant), Eigen::Vector3d::UnitY()));
        views.push_back(
            seen(truth, truth.X_WC * make_pose({-0.1, -0.06, 0.5}, R_CB), noise, random));
      }
      const auto made = calibrate(views, board, truth.width, truth.height);
      refusals.push_back(made ? "taken" : made.error().message());
    }
  EXPECT_THAT(refusals,
              testing::Contains("calibration: the focal length stays open by more than 5 % (slant "
                                "the board by 30 to 45 degrees, each way)"));
}

/// `prehend camera calibrate` in a folder of its own, with pictures and a configuration.
class CalibrateCommand : public ::testing::Test {
 protected:
  CalibrateCommand() {
    std::filesystem::create_directories(pictures_);
    std::ofstream(folder_ / "lab.toml")
        << "[lab]\nrig = \"test\"\n[camera]  # ours\nname = \"left\"\n";
  }
  ~CalibrateCommand() override { std::filesystem::remove_all(folder_); }

  int run(const std::string& arguments) {
    const std::string command = test::in_programs("prehend-camera") + " calibrate --config " +
                                (folder_ / "lab.toml").string() + " " + arguments + " >" +
                                (folder_ / "out").string() + " 2>" + (folder_ / "err").string();
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string text(const char* file) const {
    std::ifstream stream(folder_ / file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void shoot(const std::string& name, const Picture& picture) {
    ASSERT_TRUE(save_png(pictures_ / name, picture));
  }
  /// How far X_WC of the printed document is from the truth, m.
  double off() const {
    const auto document = nlohmann::json::parse(text("out"));
    const auto& p = document["camera"]["X_WC"];
    return (Eigen::Vector3d(p[0], p[1], p[2]) - true_camera().X_WC.translation()).norm();
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("boards" + std::to_string(getpid()));
  std::filesystem::path pictures_ = folder_ / "pictures";
};

TEST_F(CalibrateCommand, WritesTheLabsKeys) {
  for (std::size_t i = 0; i < shots().size(); ++i)
    shoot(std::to_string(100 + i) + ".png", shots()[i]);
  std::ofstream(pictures_ / "200.png") << "no picture";
  const std::string pictures = pictures_.string();
  EXPECT_EQ(run(pictures + " --place -0.1,0.05,0.3 --write --json"), 0);
  const auto document = nlohmann::json::parse(text("out"));  // nothing else is printed
  EXPECT_EQ(document["camera"]["X_WC"].size(), 7u);
  EXPECT_EQ(document["left_out"].back(), "200.png");
  const std::string lab = text("lab.toml");
  for (const char* key : {"[camera]  # ours", "name = \"left\"", "width = 640", "height = 480",
                          "focal = [60", "centre = [32", "distortion = [-0.1", "X_WC = ["})
    EXPECT_NE(lab.find(key), std::string::npos) << key << " in " << lab;
  // What it wrote is a configuration that the same command takes.
  EXPECT_EQ(run(pictures + " --only place --place -0.1,0.05,0.3"), 0);
  EXPECT_EQ(run(pictures + " --worst 0.01"), 1);
  EXPECT_EQ(run(pictures + " --columns 8"), 2);  // looks the same upside down
  EXPECT_EQ(run(pictures + " --place 1,2"), 2);  // three numbers
  std::filesystem::create_directories(folder_ / "bare");
  ASSERT_TRUE(save_png(folder_ / "bare" / "1.png", Picture(640, 480)));
  EXPECT_EQ(run((folder_ / "bare").string()), 1);  // no board in sight
  EXPECT_EQ(run((folder_ / "none").string()), 3);
  EXPECT_EQ(run("device:/dev/none"), 3);
  EXPECT_EQ(run(""), 2);
}

// Guards the table's picture: another one was taken in its stead, and the camera placed elsewhere.
TEST_F(CalibrateCommand, TheTablesPictureIsNeverAnotherOne) {
  for (std::size_t i = 0; i < shots().size(); ++i)
    shoot("s" + std::to_string(i + 2) + ".png", shots()[i]);
  const std::string at = pictures_.string() + " --place -0.1,0.05,0.3 --json ";
  // s2 comes before s10; the first is named.
  ASSERT_EQ(run(at), 0) << text("err");
  EXPECT_LT(off(), 0.01);
  EXPECT_NE(text("out").find("/s2.png\""), std::string::npos) << text("out");
  EXPECT_NE(text("err").find("s2.png"), std::string::npos) << text("err");
  // An unreadable first picture, and one without the board, are errors that name it.
  std::ofstream(pictures_ / "s1.png") << "no picture";
  EXPECT_EQ(run(at), 3);
  EXPECT_NE(text("err").find("s1.png"), std::string::npos) << text("err");
  EXPECT_NE(text("err").find("--table-picture"), std::string::npos) << text("err");
  EXPECT_EQ(run(at + "--only intrinsics"), 0);  // does not ask for the table
  shoot("s1.png", Picture(640, 480));
  EXPECT_EQ(run(at), 1);
  EXPECT_NE(text("err").find("s1.png"), std::string::npos) << text("err");
  // Chosen by name or path, it is taken wherever it stands.
  ASSERT_EQ(run(at + "--table-picture s2.png"), 0) << text("err");
  EXPECT_LT(off(), 0.01);
  ASSERT_EQ(run(at + "--table-picture " + (pictures_ / "s2.png").string()), 0) << text("err");
  EXPECT_LT(off(), 0.01);
  EXPECT_EQ(run(at + "--table-picture absent.png"), 3);
  EXPECT_NE(text("err").find("absent.png"), std::string::npos) << text("err");
}

// Guards the place against pictures of another size than the lens was calibrated for.
TEST_F(CalibrateCommand, ALensOfAnotherSizePlacesNothing) {
  shoot("1.png", draw(true_camera(), lying(-0.1, 0.05, 0.3), 0));
  const std::string place = pictures_.string() + " --only place --place -0.1,0.05,0.3 --set ";
  EXPECT_EQ(run(place + "camera.width=480 --set camera.height=640"), 2);
  EXPECT_NE(text("err").find("640x480"), std::string::npos) << text("err");
  EXPECT_NE(text("err").find("480x640"), std::string::npos) << text("err");
  shoot("2.png", Picture(320, 240));
  EXPECT_NE(run(pictures_.string() + " --place -0.1,0.05,0.3"), 0);
  EXPECT_NE(text("err").find("2.png: has 320x240 px, those before 640x480 (all pictures of a"),
            std::string::npos)
      << text("err");
}

// Pictures with and without a turn in their EXIF tags, the pixels the same.
TEST_F(CalibrateCommand, ExifTurnsChangeNothing) {
  const auto pictures = shared_data() / "strangers" / "19-exif-turned-pictures";
  if (!std::filesystem::exists(pictures)) GTEST_SKIP() << "no " << pictures;
  std::vector<nlohmann::json> documents;
  for (const char* folder : {"plain", "tagged"}) {
    ASSERT_EQ(run((pictures / folder).string() + " --json"), 0) << text("err");
    documents.push_back(nlohmann::json::parse(text("out"))["camera"]);
  }
  EXPECT_EQ(documents[0], documents[1]);
}

TEST(BoardTaker, TakesStillAndDifferentViewsOnly) {
  const CameraModel camera = true_camera();
  BoardTaker taker(board, 2);
  const Picture first = draw(camera, lying(-0.1, 0.0, 0), 1);
  EXPECT_FALSE(taker.see(Picture(640, 480)));
  EXPECT_NE(taker.hint().find("in sight"), std::string::npos);
  EXPECT_FALSE(taker.see(first));
  EXPECT_FALSE(taker.see(first));
  EXPECT_TRUE(taker.see(first));   // the third in a row in which it lies still
  EXPECT_FALSE(taker.see(first));  // the same again
  EXPECT_NE(taker.hint().find("slanted"), std::string::npos);
  const Picture second = draw(camera, lying(-0.08, 0.14, 0), 2);
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(taker.see(second));
  EXPECT_TRUE(taker.see(second));
  EXPECT_TRUE(taker.done());
  EXPECT_EQ(taker.views().size(), 2u);
}

}  // namespace
}  // namespace prehend::recognition
