// A real recognition process before a real stream (motion jpeg over HTTP): what it publishes
// follows the camera through other resolutions and interruptions, its preview shows what it
// publishes, and an object that it never saw is learned from its camera/image while it runs. What
// stands before the camera is rendered, so its truth is known: 1 cm is the aim in the open at 1 m.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "common/base/file_text.hpp"
#include "common/dds/topics.hpp"
#include "common/model/scene.hpp"
#include "services/recognition/core/geometry/silhouette.hpp"
#include "services/recognition/core/rendering/renderer.hpp"
#include "services/recognition/files/picture_file.hpp"
#include "tests/integration/rig.hpp"
#include "tests/integration/stream_camera.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::integration {
namespace {

using recognition::CameraModel;
using recognition::Picture;
using recognition::TablePose;

/// As the configuration has it.
CameraModel lab_camera() {
  CameraModel camera;
  camera.X_WC = make_pose({0, -0.75, 0.8},
                          Eigen::Quaterniond(0.36650123, -0.93041757, 0, 0).toRotationMatrix());
  return camera;
}

constexpr const char* tin =
    "\n[[object]]\nname = \"Tin\"\nshape = \"cylinder\"\nsize = [0.035, 0.035, 0.11]\nmass = 0.3\n"
    "material = \"plastic\"\n[object.appearance]\ncolours = [[0.35, 0.16, 0.45], [0.85, 0.9, 0.3], "
    "[0.9, 0.9, 0.9]]\npattern = \"label\"\nseed = 77\n";

class Cameras : public Rig {
 protected:
  Cameras() {
    std::filesystem::copy_file(test::in_sources("common/models/objects/catalogue.toml"),
                               folder_ / "known.toml");
    std::filesystem::copy_file(folder_ / "known.toml", folder_ / "world.toml");
    std::ofstream(folder_ / "world.toml", std::ios::app) << tin;
    world_ = model::Catalogue::load(folder_ / "world.toml").value();
    renderer_.emplace(world_);
  }

  Picture table(const std::string& name = "", const TablePose& at = {},
                const CameraModel& camera = lab_camera()) const {
    model::Scene scene;
    if (!name.empty())
      scene.objects.push_back({name, recognition::standing_pose(world_.find(name)->shape, at)});
    return renderer_->render_still(scene, camera);
  }
  stage::Process start_recognition(const StreamCamera& camera, Strings sets = {}) {
    sets.insert(sets.end(), {"recognition.source=video", "recognition.path=" + camera.address(),
                             "recognition.rate=20"});
    return start("recognition", sets);
  }
  /// A detection of the name within 1 cm of the place, of a picture exposed after `since`.
  std::optional<v1::ObjectDetection> hear_at(const std::string& name, double x, double y,
                                             std::int64_t since = now_ns()) {
    return hear<v1::ObjectDetection>(detections_, 20, [&](const auto& d) {
      return d.stamp_ns() > since && d.name().to_string() == name &&
             std::hypot(d.X_WO().position().x() - x, d.X_WO().position().y() - y) < 0.01;
    });
  }
  std::optional<v1::ServiceStatus> hear_status(
      const std::function<bool(const v1::ServiceStatus&)>& condition) {
    const std::int64_t since = now_ns();
    return hear<v1::ServiceStatus>(statuses_, 20, [&](const auto& s) {
      return s.name().to_string() == "recognition" && s.stamp_ns() > since && condition(s);
    });
  }

  model::Catalogue world_;
  std::optional<recognition::Renderer> renderer_;
  dds::Reader<v1::ObjectDetection> detections_ = reader(dds::object_detection);
  dds::Reader<v1::ServiceStatus> statuses_ = reader(dds::service_status);
};

/// Share of a frame's pixels, along its four sides, that have the colour that draw_frame draws in.
double drawn(const Picture& picture, const v1::ImageBox& box) {
  int all = 0, coloured = 0;
  const auto look = [&](double px, double py) {
    const int x = static_cast<int>(px), y = static_cast<int>(py);
    if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
    const std::uint8_t* p = picture.at(x, y);
    ++all;
    coloured += p[0] > 170 && p[1] > 140 && p[2] < 120;  // 255, 220, 0 through a jpeg
  };
  for (double t = 0; t <= 1; t += 0.02) {
    for (const double side : {0.0, box.height() - 1})
      look(box.x() + t * box.width(), box.y() + side);
    for (const double side : {0.0, box.width() - 1})
      look(box.x() + side, box.y() + t * box.height());
  }
  return all > 0 ? static_cast<double>(coloured) / all : 0;
}

TEST_F(Cameras, PreviewShowsTheFramesOfWhatIsPublished) {
  const std::string preview = (folder_ / "preview.jpg").string();
  StreamCamera camera(20);
  camera.show(table("Cup", {0.05, 0.1, 0}));
  auto recognition = start_recognition(camera, {"recognition.preview=" + preview});
  const auto there = hear_at("Cup", 0.05, 0.1);
  ASSERT_TRUE(there);
  const auto shows = [&](const v1::ImageBox& box, double least, double most) {
    double share = 0;
    const bool seen = eventually(10, [&] {
      const auto picture = recognition::load_picture(preview);
      if (!picture) ADD_FAILURE() << "half a file: " << picture.error().message();
      if (!picture) return true;
      share = drawn(*picture, box);
      return share >= least && share <= most;
    });
    EXPECT_TRUE(seen) << share;
  };
  ASSERT_TRUE(eventually(10, [&] { return std::filesystem::exists(preview); }));
  shows(there->box(), 0.9, 1);
  camera.show(table("Cup", {-0.15, 0.0, 0}));
  const auto moved = hear_at("Cup", -0.15, 0.0);
  ASSERT_TRUE(moved);
  shows(moved->box(), 0.9, 1);
  shows(there->box(), 0, 0.1);  // where it was there is none any more
}

// A camera that is a node of ROS 2, of another make than ours. Its lens is compared with lab.toml.
TEST_F(Cameras, ANodeOfRosIsACamera) {
  const test::DomainLease nodes;
  ::setenv("ROS_DOMAIN_ID", std::to_string(nodes.domain()).c_str(), 1);
  const std::string file = (folder_ / "table.jpg").string();
  ASSERT_TRUE(recognition::save_jpeg(file, table("Cup", {0.05, 0.1, 0})));
  auto recognition =
      start("recognition", {"recognition.source=ros2", "recognition.path=/front/image/compressed"});
  const auto camera = [&](const std::string& focal) {
    return start_program("cyclone_ros_camera",
                         {std::to_string(nodes.domain()), "front", file, "640", "480", focal});
  };
  const auto says_other_lens = [&] {
    return read_file(recognition.log()).value_or("").find("its lens is another one") !=
           std::string::npos;
  };
  {
    auto node = camera("620");
    EXPECT_TRUE(hear_at("Cup", 0.05, 0.1));
    EXPECT_FALSE(says_other_lens()) << *read_file(recognition.log());
    node.stop(seconds(10));
  }
  EXPECT_TRUE(hear_status([](const auto& s) {
    return s.message().to_string().find("/front/image/compressed: no pictures come") == 0;
  }));
  EXPECT_EQ(recognition.stop(seconds(10)).code, 0);

  recognition =
      start("recognition", {"recognition.source=ros2", "recognition.path=/front/image/compressed"});
  auto node = camera("700");
  EXPECT_TRUE(eventually(30, says_other_lens));
  EXPECT_NE(read_file(recognition.log())->find("camera.focal = [700.0, 700.0]"), std::string::npos);
  ::unsetenv("ROS_DOMAIN_ID");
}

// Most drivers tell raw pictures, and nothing else.
TEST_F(Cameras, RawPicturesOfANodeAreTaken) {
  const test::DomainLease nodes;
  ::setenv("ROS_DOMAIN_ID", std::to_string(nodes.domain()).c_str(), 1);
  const recognition::Picture picture = table("Cup", {0.05, 0.1, 0});
  const std::string file = (folder_ / "table.rgb").string();
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(picture.rgb.data()),
             static_cast<std::streamsize>(picture.rgb.size()));
  auto recognition =
      start("recognition", {"recognition.source=ros2", "recognition.path=/front/image_raw"});
  auto node = start_program("cyclone_ros_camera",
                            {std::to_string(nodes.domain()), "front", file,
                             std::to_string(picture.width), std::to_string(picture.height), "620"});
  EXPECT_TRUE(hear_at("Cup", 0.05, 0.1)) << read_file(recognition.log()).value_or("");
  ::unsetenv("ROS_DOMAIN_ID");
}

TEST_F(Cameras, ResolutionMayChangeButNotTheRatioOfSides) {
  StreamCamera camera(20);
  auto recognition = start_recognition(camera);
  double width_before = 0;
  for (const double factor : {1.0, 2.0, 1.25, 1.0}) {
    const double x = 0.05 * factor;  // elsewhere each time, so that nothing old is heard
    camera.show(table("Pringles", {x, 0.05, 0}, lab_camera().scaled(factor)));
    const auto seen = hear_at("Pringles", x, 0.05);
    ASSERT_TRUE(seen) << factor;
    // Boxes are in pixels of the camera's own pictures.
    if (width_before > 0) {
      EXPECT_NEAR(seen->box().width() / factor / width_before, 1, 0.15);
    } else {
      width_before = seen->box().width();
    }
  }
  CameraModel wide = lab_camera();
  wide.height = 400;
  camera.show(table("Pringles", {0, 0, 0}, wide));
  EXPECT_TRUE(hear_status([](const auto& s) {
    return s.state() == v1::STATE_DEGRADED &&
           s.message().to_string().find("640x400") != std::string::npos;
  }));
  camera.show(table("Pringles", {0, 0, 0}));
  EXPECT_TRUE(hear_at("Pringles", 0, 0));
  EXPECT_TRUE(hear_status([](const auto& s) { return s.state() == v1::STATE_RUNNING; }));
  EXPECT_FALSE(recognition.exit());
}

TEST_F(Cameras, StreamThatGoesIsSaidAndTakenUpAgain) {
  StreamCamera camera(20);
  camera.show(table("Talc", {0.1, 0.05, 0}));
  auto recognition = start_recognition(camera);
  ASSERT_TRUE(hear_at("Talc", 0.1, 0.05));
  for (int life = 0; life < 2; ++life) {
    camera.off();
    const auto degraded =
        hear_status([](const auto& s) { return s.state() == v1::STATE_DEGRADED; });
    ASSERT_TRUE(degraded);
    EXPECT_NE(degraded->message().to_string().find(camera.address()), std::string::npos)
        << degraded->message().to_string();
    camera.on();
    EXPECT_TRUE(hear_at("Talc", 0.1, 0.05));
    EXPECT_TRUE(hear_status([](const auto& s) { return s.state() == v1::STATE_RUNNING; }));
  }
  EXPECT_FALSE(recognition.exit());
}

TEST_F(Cameras, ABoardThatIsNeverShownIsWaitedForAsLongAsIsSaid) {
  StreamCamera camera(20);
  camera.show(table());
  const Answer answer =
      run("prehend-camera", {"calibrate", "video:" + camera.address(), "--limit", "1"}, 30);
  EXPECT_NE(answer.exit_code, 0);
  EXPECT_NE(answer.log.find("calibration: only 0 of 20 views within 1 s (the board is not"),
            std::string::npos)
      << answer.log;
}

TEST_F(Cameras, ObjectLearnedFromTheRunningLabIsRecognised) {
  const std::filesystem::path model = folder_ / "objects.model", known = folder_ / "known.toml";
  std::filesystem::copy_file(test::in_share("trained/objects.model"), model);
  StreamCamera camera(20);
  camera.show(table());
  const Strings own{"recognition.model=" + model.string(), "lab.catalogue=" + known.string()};
  {
    auto recognition = start_recognition(camera, own);
    auto pictures = reader(dds::camera_image);
    ASSERT_TRUE(hear<v1::CameraImage>(pictures, 20, [](const auto&) { return true; }));
    constexpr int views = 8;
    auto add = start_program("prehend-objects",
                             with_lab({"add", "Tin", "--shape", "cylinder", "--size", "0.035,0.11",
                                       "--views", std::to_string(views), "--model", model.string(),
                                       "--catalogue", known.string()}));
    const auto log = [&] {
      std::ifstream stream(folder_ / "prehend-objects.log");
      return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    const auto says = [&](const std::string& words) {
      return eventually(30, [&] { return log().find(words) != std::string::npos || add.exit(); }) &&
             log().find(words) != std::string::npos;
    };
    const std::int64_t begin = now_ns();
    ASSERT_TRUE(says("put the object on the table")) << log();
    for (int i = 1; i <= views; ++i) {  // turned and moved a little, as a person does
      camera.show(table("Tin", {0.03 * std::cos(i), 0.03 * std::sin(2 * i), 0.8 * i}));
      ASSERT_TRUE(says("view " + std::to_string(i) + " of")) << log();
    }
    const auto ended = add.wait(seconds(30));
    ASSERT_TRUE(ended);
    ASSERT_EQ(ended->code, 0) << log();
    const double took = 1e-9 * static_cast<double>(now_ns() - begin);
    RecordProperty("seconds", std::to_string(took));
    EXPECT_LT(took, 60);
  }
  camera.show(table("Tin", {0.12, 0.1, 2.2}));
  auto recognition = start_recognition(camera, own);
  EXPECT_TRUE(hear_at("Tin", 0.12, 0.1));
  // And what was known still is.
  camera.show(table("Cup", {-0.1, 0.05, 0}));
  EXPECT_TRUE(hear_at("Cup", -0.1, 0.05));
}

}  // namespace
}  // namespace prehend::integration
