#include "services/console/core/lab_view.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/base/base64.hpp"
#include "services/console/core/resisted_forces.hpp"

namespace prehend::console {
namespace {

constexpr std::string_view table = "table";
constexpr Colour link_colour{0.62, 0.66, 0.72, 1};
constexpr Colour object_colour{0.91, 0.58, 0.18, 1};
constexpr Colour seen_colour{0.20, 0.60, 0.86, 0.25};
constexpr Colour glove_colour{0.90, 0.72, 0.60, 0.8};
constexpr Colour contact_colour{0.85, 0.15, 0.20, 1};
constexpr Colour cone_colour{0.85, 0.15, 0.20, 0.25};
constexpr Colour table_colour{0.55, 0.50, 0.45, 0.35};
constexpr Colour doubt_colour{0.20, 0.60, 0.86, 0.35};
constexpr Colour forces_colour{0.55, 0.35, 0.80, 0.25};
constexpr Colour white{1, 1, 1, 1};
constexpr double forces_scale = 0.1;  // m for 1 N
constexpr std::array finger_names{"thumb", "index", "middle", "ring", "little"};

/// From green, which is hardly felt, to red: 20 N and more.
Colour pressure_colour(double newtons) {
  const double share = std::clamp(newtons / 20, 0.0, 1.0);
  return {0.15 + 0.7 * share, 0.75 - 0.6 * share, 0.2, 1};
}

std::string object_frame(const std::string& body) {
  return "object/" + body;
}

std::int64_t stamp(View message) {
  return message["stamp_ns"].integer();
}

model::Shape shape_of(View message) {
  const std::string kind = message["shape"].text();
  model::Shape shape{model::ShapeKind::unknown, message["size"].vector()};
  if (kind == "SHAPE_CYLINDER") shape.kind = model::ShapeKind::cylinder;
  if (kind == "SHAPE_BOX") shape.kind = model::ShapeKind::box;
  if (kind == "SHAPE_SPHERE") shape.kind = model::ShapeKind::sphere;
  return shape;
}

/// Where it may be: two standard deviations to each side. Nothing where that is not known.
void add_doubt(Json& drawn, const std::vector<double>& covariance, const Eigen::Vector3d& at) {
  constexpr double thinnest = 1e-4, widest = 1;  // m
  if (covariance.size() != 16) return;
  const Eigen::Matrix3d of_place =
      Eigen::Map<const Eigen::Matrix4d>(covariance.data()).topLeftCorner<3, 3>();
  if (!of_place.allFinite()) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solved(of_place);
  const Eigen::Vector3d half = 2 * solved.eigenvalues().cwiseMax(0).cwiseSqrt();
  if (!half.allFinite() || half.maxCoeff() < thinnest || half.maxCoeff() > widest) return;
  Eigen::Matrix3d axes = solved.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  add_ellipsoid(drawn, half.cwiseMax(thinnest), make_pose(at, axes), doubt_colour);
}

/// The axes of a frame, as red, green and blue arrows.
void add_axes(Json& drawn, const Pose& X) {
  constexpr double length = 0.04, thickness = 0.002;  // m
  for (int i = 0; i < 3; ++i)
    add_arrow(drawn, X.translation(), length * X.linear().col(i), thickness,
              {i == 0 ? 0.85 : 0.1, i == 1 ? 0.7 : 0.1, i == 2 ? 0.9 : 0.1, 1});
}

/// Of which joint angles a state tells, or nothing where its numbers do not fit the model.
std::optional<Eigen::VectorXd> joints_of(View state, const model::HandModel& model) {
  const auto take = [](const std::vector<double>& values) {
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  Eigen::VectorXd joints;
  if (const auto all = state["joint"].numbers(); all.size() == model.joints().size())
    joints = take(all);
  else if (const auto dof = state["dof"].numbers(); dof.size() == model.dofs().size())
    joints = model.joint_angles(take(dof));
  else
    return std::nullopt;
  if (!joints.allFinite()) return std::nullopt;
  return joints;
}

}  // namespace

Document LabView::scene(Json entity, const std::string& key, std::int64_t ns) {
  return {Feed::scene, key, ns, text_of(scene_with(std::move(entity)))};
}

Document LabView::signals(std::int64_t ns, std::string_view group, const std::string& source,
                          std::string_view unit, Json names, Json values) {
  return {Feed::signals, fmt::format("{}/{}", group, source), ns,
          text_of({{"timestamp", to_time(ns)},
                   {"group", group},
                   {"source", source},
                   {"unit", unit},
                   {"names", std::move(names)},
                   {"values", std::move(values)}})};
}

Documents LabView::begin(std::int64_t now_ns) {
  Documents made;
  Json top = entity(now_ns, "table", table);
  add_shape(top, {model::ShapeKind::box, {1.0, 1.2, 0.01}},
            make_pose(Eigen::Vector3d(0, 0, -0.005)), table_colour);
  made.push_back(scene(std::move(top), "table", now_ns));
  Document& camera = made.emplace_back(Feed::tf, options_.camera, now_ns);
  add_transform(camera.text, now_ns, table, options_.camera, options_.X_WC);
  made.push_back(status(now_ns));
  made.push_back(latency(now_ns));
  made.push_back(annotations(now_ns));
  return made;
}

Documents LabView::hear(std::string_view topic, const Value& value, std::int64_t now_ns) {
  const View message(value);
  if (topic == "robot/state") return robot_state(message);
  if (topic == "robot/touch") return robot_touch(message);
  if (topic == "glove/feedback") return glove_feedback(message);
  if (topic == "robot/command") return robot_command(message);
  if (topic == "object/state") return object_state(message);
  if (topic == "scene/state") return scene_state(message);
  if (topic == "hand/posture") return hand_posture(message);
  if (topic == "camera/image") return camera_image(message);
  if (topic == "object/detection") return object_detection(message);
  if (topic == "grasp/report") return grasp_report(value);
  if (topic == "service/status") return told(roster_.hear_status(message, now_ns), stamp(message));
  if (topic == "robot/gate") return told(roster_.hear_gate(message), now_ns);
  if (topic == "mapping/training")
    return {{Feed::training, message["hand"].text(), stamp(message), text_of(to_json(value))}};
  if (topic == "operator/reply") return operator_reply(value);
  if (topic == "operator/command") return operator_command(message);
  return {};
}

Documents LabView::lose(std::string_view topic, const Value& last, std::int64_t now_ns) {
  const View message(last);
  const auto end = [&](const std::string& id) {
    return Document{Feed::scene, id, now_ns, text_of(scene_without(now_ns, id)), true};
  };
  if (topic == "hand/posture") return {end("glove/" + message["glove"].text())};
  if (topic == "robot/gate") return told(roster_.lose_gate(message), now_ns);
  if (topic == "service/status") return told(roster_.lose_status(message), now_ns);
  if (topic == "object/detection") {
    const std::int64_t track = message["track"].integer();
    detections_.erase(track);
    return {end(fmt::format("seen/{}", track)), annotations(now_ns)};
  }
  return {};
}

Documents LabView::wait(std::int64_t now_ns) {
  return told(roster_.wait(now_ns), now_ns);
}

Documents LabView::told(const Roster::News& news, std::int64_t at_ns) {
  Documents made;
  for (const auto& [level, name, text] : news.events) made.push_back(log(at_ns, level, name, text));
  if (news.services || news.gates) made.push_back(status(at_ns));
  if (news.services) made.push_back(latency(at_ns));
  return made;
}

Document LabView::status(std::int64_t ns) const {
  return {Feed::status, "", ns, text_of(roster_.everybody())};
}

Document LabView::latency(std::int64_t ns) const {
  return {Feed::latency, "", ns, text_of(roster_.latency())};
}

Documents LabView::links_of(const std::string& hand, const model::HandModel& model,
                            std::int64_t ns) {
  Documents made;
  for (const model::HandLink& link : model.links()) {
    const std::string id = hand + "/" + link.name;
    Json drawn = entity(ns, id, link.name);
    for (const model::CollisionShape& shape : link.collision)
      add_shape(drawn, shape.shape, shape.X_LS, link_colour);
    made.push_back(scene(std::move(drawn), id, ns));
  }
  const std::string id = hand + "/grasp frame";
  Json drawn = entity(ns, id, model.links()[0].name);
  add_axes(drawn, model.X_BG());
  made.push_back(scene(std::move(drawn), id, ns));
  return made;
}

Documents LabView::robot_state(View message) {
  const std::string hand = message["hand"].text(), kind = message["model"].text();
  const model::HandModel* model = options_.hand(kind);
  const auto X_WB = message["X_WB"].pose();
  if (!model || !X_WB) return {};
  const auto joints = joints_of(message, *model);
  if (!joints) return {};
  const std::int64_t ns = stamp(message);
  Documents made;
  if (std::string& drawn = drawn_hands_[hand]; drawn != kind) {
    drawn = kind;
    made = links_of(hand, *model, ns);
  }
  Document& frames = made.emplace_back(Feed::tf, "hand/" + hand, ns);
  const auto poses = model->link_poses(*joints);
  for (std::size_t i = 0; i < poses.size(); ++i)
    add_transform(frames.text, ns, table, model->links()[i].name, *X_WB * poses[i]);
  Json names = Json::array();
  for (const model::HandJoint& joint : model->joints()) names.push_back(joint.name);
  made.push_back(signals(ns, "joints", hand, "rad", std::move(names),
                         std::vector<double>(joints->begin(), joints->end())));
  return made;
}

/// What each link feels, as it feels it: where, how hard, which way.
Documents LabView::robot_touch(View message) {
  const std::string hand = message["hand"].text();
  const model::HandModel* model = options_.hand(message["model"].text());
  if (!model) return {};
  const std::string id = "touch/" + hand;
  Json drawn = entity(stamp(message), id, model->links()[0].name);
  for (const View& pad : message["pads"].elements()) {
    const Eigen::Vector3d at = pad["p_BC"].vector(), force = pad["force_B"].vector();
    const double pressure = pad["pressure"].number();
    if (!pad["touching"].flag() || !at.allFinite() || !force.allFinite() || !(pressure >= 0))
      continue;
    const Colour colour = pressure_colour(pressure);
    add_shape(drawn, {model::ShapeKind::sphere, Eigen::Vector3d::Constant(0.006)}, make_pose(at),
              colour);
    if (force.norm() > 1e-3)
      add_arrow(drawn, at, std::min(0.005, 0.1 / force.norm()) * force, 0.003, colour);
  }
  return {scene(std::move(drawn), id, stamp(message))};
}

Documents LabView::glove_feedback(View message) {
  Json names = Json::array(), forces = Json::array();
  std::size_t finger = 0;
  for (const View& felt : message["fingers"].elements()) {
    if (finger >= finger_names.size()) break;
    names.push_back(finger_names[finger++]);
    forces.push_back(felt["force"].number());
  }
  return {signals(stamp(message), "touch", message["glove"].text(), "N on the robot's finger",
                  std::move(names), std::move(forces))};
}

Documents LabView::robot_command(View message) {
  const double weight = message["weight"].number();
  if (!std::isfinite(weight)) return {};
  return {signals(stamp(message), "weight", message["hand"].text(), "",
                  Json::array({"intelligent answer"}), Json::array({weight}))};
}

Documents LabView::object_state(View message) {
  const auto X_WO = message["X_WO"].pose();
  if (!X_WO) return {};
  Document made{Feed::tf, object_frame(message["body"].text()), stamp(message)};
  add_transform(made.text, made.stamp_ns, table, made.key, *X_WO);
  return {std::move(made)};
}

Documents LabView::scene_state(View message) {
  const std::int64_t ns = stamp(message);
  Documents made;
  std::set<std::string> there;
  for (const View& body : message["bodies"].elements()) {
    const std::string frame = object_frame(body["name"].text());
    const model::Shape shape = shape_of(body);
    if (!model::is_valid(shape)) continue;
    Json drawn = entity(ns, frame, frame);
    add_shape(drawn, shape, Pose::Identity(), object_colour);
    made.push_back(scene(std::move(drawn), frame, ns));
    there.insert(frame);
  }
  std::set<std::string>& drawn = drawn_bodies_[message["scene"].text()];
  for (const std::string& id : drawn)
    if (!there.contains(id))
      made.push_back({Feed::scene, id, ns, text_of(scene_without(ns, id)), true});
  drawn = std::move(there);
  return made;
}

Documents LabView::hand_posture(View message) {
  const auto X_WH = message["X_WH"].pose();
  if (!X_WH) return {};
  const std::string id = "glove/" + message["glove"].text();
  const std::int64_t ns = stamp(message);
  Json drawn = entity(ns, id, table);
  const Eigen::Vector3d back = X_WH->translation();
  const auto ball = [&](const Eigen::Vector3d& at, double radius) {
    add_shape(drawn, {model::ShapeKind::sphere, Eigen::Vector3d::Constant(radius)}, make_pose(at),
              glove_colour);
  };
  ball(back, 0.012);
  Json names = Json::array(), distances = Json::array();
  std::size_t finger = 0;
  for (const View& tip : message["fingertips"].elements()) {
    const char* name = finger < finger_names.size() ? finger_names[finger++] : "";
    const Eigen::Vector3d at = *X_WH * tip["p_HF"].vector();
    if (!tip["valid"].flag() || !at.allFinite()) continue;
    ball(at, 0.008);
    add_line(drawn, {back, at}, glove_colour);
    names.push_back(name);
    distances.push_back((at - back).norm());
  }
  return {scene(std::move(drawn), id, ns),
          signals(ns, "fingertips", message["glove"].text(), "m from the back of the hand",
                  std::move(names), std::move(distances))};
}

Documents LabView::camera_image(View message) {
  const std::int64_t ns = stamp(message);
  const std::string camera = message["camera"].text();
  return {{Feed::image, camera, ns,
           text_of({{"timestamp", to_time(ns)},
                    {"frame_id", camera},
                    {"data", base64(message["data"].bytes())},
                    {"format", message["encoding"].text()}})}};
}

Documents LabView::object_detection(View message) {
  const std::int64_t track = message["track"].integer(), ns = stamp(message);
  const View box = message["box"];
  const Detection seen{message["name"].text(), message["probability"].number(),
                       box["x"].number(),      box["y"].number(),
                       box["width"].number(),  box["height"].number()};
  if (std::isfinite(seen.x + seen.y + seen.width + seen.height + seen.probability))
    detections_[track] = seen;
  Documents made{annotations(ns)};
  const auto X_WO = message["X_WO"].pose();
  const model::Shape shape = shape_of(message);
  if (!X_WO || !model::is_valid(shape)) return made;
  const std::string id = fmt::format("seen/{}", track);
  Json drawn = entity(ns, id, table);
  add_shape(drawn, shape, *X_WO, seen_colour);
  add_doubt(drawn, message["covariance"].numbers(), X_WO->translation());
  made.push_back(scene(std::move(drawn), id, ns));
  return made;
}

Documents LabView::grasp_report(const Value& value) {
  const View message(value);
  const std::int64_t ns = stamp(message);
  const std::string hand = message["hand"].text(), object = message["object"].text();
  const double epsilon = message["epsilon"].number();
  const bool held = message["held"].flag();
  Documents made{{Feed::report, std::to_string(count_++), ns, text_of(to_json(value))}};
  const std::string id = "contacts/" + hand;
  Json drawn = entity(ns, id, object_frame(object));
  std::vector<analysis::Contact> contacts;
  for (const View& contact : message["contacts"].elements()) {
    const Eigen::Vector3d at = contact["p_OC"].vector(), normal = contact["normal_O"].vector();
    const double force = contact["force"].number();
    if (!at.allFinite() || !normal.allFinite() || !std::isfinite(force) || normal.norm() < 1e-6)
      continue;
    const Eigen::Vector3d along = std::clamp(0.01 * force, 0.015, 0.1) * normal.normalized();
    add_arrow(drawn, at - along, along, 0.003, contact_colour);
    const double friction = contact["friction"].number();
    if (!(friction > 0)) continue;
    add_cone(drawn, at, normal, std::atan(friction), cone_colour);
    contacts.push_back({"", at, normal.normalized(), friction, force, 0});
  }
  const std::string verdict = held ? "held" : "dropped: " + message["reason"].text();
  add_text(drawn, {0, 0, 0.15}, fmt::format("ε {:.3f}, {}", epsilon, verdict), white);
  made.push_back(scene(std::move(drawn), id, ns));
  Json hull = entity(ns, "forces/" + hand, object_frame(object));
  std::vector<Eigen::Vector3d> corners = resisted_forces(contacts);
  for (Eigen::Vector3d& corner : corners) corner *= forces_scale;
  if (!corners.empty()) add_triangles(hull, corners, forces_colour);
  made.push_back(scene(std::move(hull), "forces/" + hand, ns));
  made.push_back(log(ns, held ? LogLevel::info : LogLevel::warning, hand,
                     fmt::format("{}: {} contacts, ε {:.3f}, {}", object,
                                 message["contacts"].elements().size(), epsilon, verdict)));
  return made;
}

Documents LabView::operator_reply(const Value& value) {
  const View message(value);
  const std::int64_t ns = stamp(message);
  const bool done = message["done"].flag();
  return {{Feed::reply, std::to_string(count_++), ns, text_of(to_json(value))},
          log(ns, done ? LogLevel::info : LogLevel::warning, message["service"].text(),
              message["message"].text())};
}

Documents LabView::operator_command(View message) {
  const std::string argument = message["argument"].text();
  return {log(stamp(message), LogLevel::info, "operator",
              fmt::format("{} for {}{}", message["action"].text(), message["target"].text(),
                          argument.empty() ? "" : ": " + argument))};
}

Document LabView::log(std::int64_t ns, LogLevel level, std::string_view name,
                      std::string_view text) {
  return {Feed::log, std::to_string(count_++), ns, text_of(log_line(ns, level, name, text))};
}

Document LabView::annotations(std::int64_t ns) const {
  Json points = Json::array(), texts = Json::array();
  constexpr Colour line{0.13, 0.85, 0.35, 1};
  for (const auto& [track, seen] : detections_) {
    const auto point = [](double x, double y) { return Json{{"x", x}, {"y", y}}; };
    const double right = seen.x + seen.width, below = seen.y + seen.height;
    points.push_back(
        {{"timestamp", to_time(ns)},
         {"type", 2},  // a closed line
         {"points",
          {point(seen.x, seen.y), point(right, seen.y), point(right, below), point(seen.x, below)}},
         {"outline_color", to_json(line)},
         {"outline_colors", Json::array()},
         {"fill_color", to_json(Colour{0, 0, 0, 0})},
         {"thickness", 2.0}});
    texts.push_back({{"timestamp", to_time(ns)},
                     {"position", point(seen.x, std::max(0.0, seen.y - 4))},
                     {"text", fmt::format("{} {:.2f}", seen.name, seen.probability)},
                     {"font_size", 14.0},
                     {"text_color", to_json(white)},
                     {"background_color", to_json(Colour{0, 0, 0, 0.6})}});
  }
  return {Feed::annotations, "", ns,
          text_of({{"circles", Json::array()}, {"points", points}, {"texts", texts}})};
}

}  // namespace prehend::console
