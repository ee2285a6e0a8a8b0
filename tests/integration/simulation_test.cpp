// The simulation alone over real DDS: commands at 30 Hz reach for an object that was only seen,
// close and lift; the report comes while the world goes on, and commands that cannot be followed
// are counted.
#include "common/convert/convert.hpp"
#include "tests/integration/rig.hpp"
#include "tests/support/hands.hpp"

namespace prehend::integration {
namespace {

using Eigen::Vector3d;

/// Where the palm is, and how far the fingers have closed, rad.
v2::HandCommand command(const Vector3d& p_WG, double closure) {
  Eigen::Matrix3d R;  // palm along y, its x axis up
  R.col(0) = Vector3d::UnitZ();
  R.col(2) = Vector3d::UnitY();
  R.col(1) = R.col(2).cross(R.col(0));
  v2::HandCommand message;
  message.hand("hand");
  message.model("barrett");
  message.stamp_ns(now_ns());
  message.origin_ns(now_ns());
  message.dof({0, closure, closure, closure});
  message.X_WB(convert::to_message(make_pose(p_WG, R) * test::hand("barrett").X_BG().inverse()));
  message.mode(v1::MODE_DIRECT);
  return message;
}

using Simulation = Rig;

TEST_F(Simulation, AnOperatorPlacesAnObject) {
  auto orders = writer(dds::operator_command);
  auto replies = reader(dds::operator_reply);
  auto objects = reader(dds::object_state);
  auto process = start("simulation");
  meet(orders, 2);  // the gate's and the world's
  const auto answer = [&](const char* id, const char* name, double x) {
    v1::OperatorCommand order;
    order.id(id);
    order.action(v1::ACTION_PLACE_OBJECT);
    order.target("simulation");
    order.argument(name);
    order.X_WO(convert::to_message(make_pose(Vector3d(x, 0, 0))));
    // Until the simulation knows who gives it, it is refused.
    std::optional<v1::OperatorReply> reply;
    eventually(20, [&] {
      order.stamp_ns(now_ns());
      orders.write(order);
      reply = hear<v1::OperatorReply>(replies, 1, [&](const auto& one) {
        return one.id().to_string() == id &&
               (one.done() || one.message().to_string().find("catalogue") != std::string::npos);
      });
      return reply.has_value();
    });
    return reply;
  };
  const auto placed = answer("1", "Talc", 0.2);
  ASSERT_TRUE(placed);
  EXPECT_TRUE(placed->done()) << placed->message().to_string();
  EXPECT_EQ(placed->service().to_string(), "simulation");
  const auto talc = hear<v1::ObjectState>(objects, 20, [](const auto& one) {
    return one.body().to_string() == "Talc" && std::abs(one.X_WO().position().x() - 0.2) < 1e-3;
  });
  ASSERT_TRUE(talc);
  EXPECT_GT(talc->X_WO().position().z(), 0.01) << "it stands on the table";
  const auto refused = answer("2", "no such thing", 0.4);
  ASSERT_TRUE(refused);
  EXPECT_FALSE(refused->done());
}

TEST_F(Simulation, GraspsWhatWasSeenAndReportsIt) {
  auto commands = writer(dds::robot_command);
  auto detections = writer(dds::object_detection);
  auto states = reader(dds::robot_state);
  auto objects = reader(dds::object_state);
  auto reports = reader(dds::grasp_report);
  auto statuses = reader(dds::service_status);
  auto process = start("simulation");
  ASSERT_TRUE(hear<v1::HandState>(states, 20, [](auto&) { return true; }));

  v1::ObjectDetection detection;
  detection.name("Talc");
  detection.shape(v1::SHAPE_CYLINDER);
  detection.size(convert::to_message(Vector3d(0.024, 0.024, 0.105)));
  detection.X_WO(convert::to_message(make_pose(Vector3d(0, 0, 0.05))));
  detection.stamp_ns(now_ns());
  ASSERT_TRUE(detections.write(detection));
  ASSERT_TRUE(hear<v1::ObjectState>(objects, 20, [](auto&) { return true; }));

  std::optional<v1::GraspReport> report;
  double height = 0;  // of the object in the living world
  const auto send = [&](double y, double z, double closure) {
    commands.write(command({0, y, z}, closure));
    std::this_thread::sleep_for(std::chrono::milliseconds(33));
    for (auto& sample : reports.take())
      if (!report) report = sample.data;
    for (auto& sample : objects.take())
      if (!sample.info.gone) height = sample.data.X_WO().position().z();
  };
  for (double to_go = 0.25; to_go > 0; to_go -= 0.007) send(-to_go, 0.06, 0);
  for (double closure = 0; closure < 1.4; closure += 0.06) send(0, 0.06, closure);
  ASSERT_TRUE(eventually(20, [&] {
    send(0, 0.06, 1.4);
    return report.has_value();
  })) << "no grasp/report";
  EXPECT_EQ(report->object().to_string(), "Talc");
  EXPECT_TRUE(report->held()) << report->reason().to_string();
  EXPECT_TRUE(report->force_closure());
  EXPECT_GT(report->epsilon(), 0);
  EXPECT_GE(report->contacts().size(), 3u);

  for (double lift = 0; lift < 0.12; lift += 0.005) send(0, 0.06 + lift, 1.4);
  EXPECT_TRUE(eventually(20, [&] {
    send(0, 0.18, 1.4);
    return height > 0.12;
  })) << "the living world has not lifted it";

  // Nonsense is counted; again and again, since of commands only the newest is read.
  bool wrong_length = false, not_finite = false, has_latency = false;
  EXPECT_TRUE(eventually(
      20,
      [&] {
        auto wrong = command({0, 0, 0.18}, 1.4);
        wrong.dof({0, 0});
        commands.write(wrong);
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        wrong = command({0, 0, std::nan("")}, 1.4);
        commands.write(wrong);
        send(0, 0.18, 1.4);
        for (auto& sample : statuses.take()) {
          for (const auto& drop : sample.data.drops()) {
            wrong_length |= drop.reason().to_string() == "command of wrong length";
            not_finite |= drop.reason().to_string() == "command not finite";
          }
          for (const auto& stage : sample.data.latency())
            has_latency |= stage.stage().to_string() == "glove to accepted" && stage.count() > 0;
        }
        return wrong_length && not_finite && has_latency;
      }))
      << wrong_length << not_finite << has_latency;
  EXPECT_GT(height, 0.12) << "it must be held still";
  EXPECT_EQ(process.stop(seconds(10)).code, 0);
}

}  // namespace
}  // namespace prehend::integration
