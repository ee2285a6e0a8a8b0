#include "services/recorder/tools/dataset/read_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/base/printable.hpp"
#include "common/model/human_hand.hpp"
#include "common/recording/mcap/reader.hpp"
#include "services/recorder/tools/dataset/message.hpp"
#include "services/recorder/tools/dataset/recorded_messages.hpp"

namespace prehend::recorder::dataset {
namespace {

using recording::mcap::Reader;

constexpr std::string_view demonstration = "demonstration";  // whom the operator's marks are for

/// Sizes must not change in the middle of a recording.
bool fits(const Numbers& series, const Eigen::VectorXd& values) {
  return series.empty() || series.values.front().size() == values.size();
}

Eigen::VectorXd as_vector(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

const Value::List* list(const Value& message, std::string_view field) {
  const Value* value = message.find(field);
  return value ? std::get_if<Value::List>(&value->content) : nullptr;
}

/// Takes the messages that count. Each take_...() says whether the message could be used.
class LogTaker {
 public:
  explicit LogTaker(std::string hand) : hand_(std::move(hand)) {}

  using Take = bool (LogTaker::*)(const Value&, Time);
  static const std::map<std::string, Take, std::less<>>& topics() {
    static const std::map<std::string, Take, std::less<>> table{
        {"robot/command", &LogTaker::command},      {"robot/state", &LogTaker::state},
        {"robot/touch", &LogTaker::touch},          {"arm/state", &LogTaker::arm},
        {"hand/posture", &LogTaker::posture},       {"object/state", &LogTaker::body},
        {"object/detection", &LogTaker::detection}, {"camera/image", &LogTaker::image},
        {"grasp/report", &LogTaker::report},        {"task/progress", &LogTaker::progress},
        {"operator/command", &LogTaker::order}};
    return table;
  }

  RecordingLog finish() {
    // Where the world says where things are, nobody needs what was seen of them.
    if (log_.objects.empty()) log_.objects = std::move(seen_);
    return std::move(log_);
  }

 private:
  bool of_hand(const Value& message) const { return text(message, "hand") == hand_; }
  /// A hand of another kind has other DoFs.
  bool of_model(const Value& message) {
    const std::string model = text(message, "model");
    if (log_.model.empty()) log_.model = model;
    return log_.model == model;
  }

  bool command(const Value& message, Time time) {
    if (!of_hand(message)) return true;
    const auto dof = numbers(message, "dof");
    const auto X_WB = pose(message, "X_WB");
    if (!dof || !X_WB || !of_model(message) || !fits(log_.command_dof, *dof)) return false;
    log_.command_dof.add(time, *dof);
    log_.command_X_WB.add(time, *X_WB);
    log_.command_object.add(time, text(message, "object"));
    return true;
  }

  bool state(const Value& message, Time time) {
    if (!of_hand(message)) return true;
    const auto dof = numbers(message, "dof"), joint = numbers(message, "joint"),
               velocity = numbers(message, "velocity"), torque = numbers(message, "torque");
    const auto X_WB = pose(message, "X_WB");
    if (!dof || !joint || !velocity || !torque || !X_WB || !of_model(message) ||
        !fits(log_.dof, *dof) || !fits(log_.joint, *joint) || !fits(log_.velocity, *velocity) ||
        !fits(log_.torque, *torque))
      return false;
    log_.dof.add(time, *dof);
    log_.joint.add(time, *joint);
    log_.velocity.add(time, *velocity);
    log_.torque.add(time, *torque);
    log_.X_WB.add(time, *X_WB);
    return true;
  }

  /// The links that feel something at first, whenever they do: what is not measured is not 0.
  bool touch(const Value& message, Time time) {
    if (!of_hand(message)) return true;
    const auto* pads = list(message, "pads");
    if (!pads || !of_model(message)) return false;
    std::vector<std::string> links;
    std::vector<double> force, pressure, slip;
    for (const Value& pad : *pads) {
      const auto force_B = vector(pad, "force_B");
      const auto pressed = number(pad, "pressure"), slid = number(pad, "slip");
      if (!flag(pad, "valid") || !force_B || !pressed || *pressed < 0 || !slid) continue;
      links.push_back(text(pad, "link"));
      force.insert(force.end(), force_B->begin(), force_B->end());
      pressure.push_back(*pressed);
      slip.push_back(*slid);
    }
    if (log_.touch_force.empty()) log_.touch_links = links;
    if (links != log_.touch_links || links.empty()) return true;
    log_.touch_force.add(time, as_vector(force));
    log_.touch_pressure.add(time, as_vector(pressure));
    log_.touch_slip.add(time, as_vector(slip));
    return true;
  }

  /// Of the first arm that is heard.
  bool arm(const Value& message, Time time) {
    const std::string name = text(message, "arm");
    if (arm_.empty()) arm_ = name;
    if (arm_ != name) return true;
    const auto joint = numbers(message, "joint"), velocity = numbers(message, "velocity");
    if (!joint || !velocity || !fits(log_.arm_joint, *joint) || !fits(log_.arm_velocity, *velocity))
      return false;
    log_.arm_joint.add(time, *joint);
    log_.arm_velocity.add(time, *velocity);
    return true;
  }

  /// Of the glove that is called like the hand, else of the first that is heard; the fingers that
  /// it measures at first, whenever it does.
  bool posture(const Value& message, Time time) {
    const std::string glove = text(message, "glove");
    if (glove_.empty()) glove_ = glove;
    if (glove == hand_ && glove_ != hand_) {
      glove_ = glove;
      log_.human_fingertips = {};
    }
    const auto X_WH = pose(message, "X_WH");
    const auto* tips = list(message, "fingertips");
    if (!X_WH || !tips || tips->size() != model::finger_count) return false;
    if (glove_ != glove) return true;
    std::vector<std::string> fingers;
    std::vector<double> numbers;
    for (std::size_t i = 0; i < tips->size(); ++i) {
      const auto p_HF = vector((*tips)[i], "p_HF");
      if (!flag((*tips)[i], "valid") || !p_HF) continue;
      fingers.emplace_back(model::finger_names.name(static_cast<model::Finger>(i)));
      const Eigen::Vector3d p_WF = *X_WH * *p_HF;
      numbers.insert(numbers.end(), p_WF.begin(), p_WF.end());
    }
    if (log_.human_fingertips.empty()) log_.human_fingers = fingers;
    if (fingers == log_.human_fingers && !fingers.empty())
      log_.human_fingertips.add(time, as_vector(numbers));
    return true;
  }

  static bool place(std::map<std::string, Poses>& objects, const Value& message,
                    std::string_view name, Time time) {
    const auto X_WO = pose(message, "X_WO");
    if (!X_WO) return false;
    objects[as_name(text(message, name))].add(time, *X_WO);
    return true;
  }
  bool body(const Value& message, Time time) {
    log_.simulated = true;
    return place(log_.objects, message, "body", time);
  }
  bool detection(const Value& message, Time time) { return place(seen_, message, "name", time); }

  bool image(const Value& message, Time time) {
    const auto width = number(message, "width"), height = number(message, "height");
    if (!width || !height || *width < 1 || *height < 1 || *width > 65535 || *height > 65535)
      return false;
    Camera& camera = log_.cameras[as_name(text(message, "camera"))];
    if (camera.times.empty()) {
      camera.width = static_cast<int>(*width);
      camera.height = static_cast<int>(*height);
    }
    if (camera.times.empty() || time > camera.times.back()) camera.times.push_back(time);
    return true;
  }

  bool report(const Value& message, Time time) {
    if (of_hand(message))
      log_.judgements.push_back({time, text(message, "object"), flag(message, "held")});
    return true;
  }

  bool progress(const Value& message, Time time) {
    if (!of_hand(message)) return true;
    const std::string task = text(message, "task"), state = text(message, "state");
    if (state == "TASK_RUNNING") {
      if (!running_ || running_->task != task) running_ = Attempt{time, time, task, {}};
    } else if (running_ && running_->task == task) {
      running_->end = time;
      running_->success = state == "TASK_DONE";
      log_.runs.push_back(*std::exchange(running_, std::nullopt));
    }
    return true;
  }

  bool order(const Value& message, Time time) {
    if (text(message, "target") != demonstration) return true;
    const std::string action = text(message, "action");
    if (action == "ACTION_START") showing_ = Attempt{time, time, text(message, "argument"), {}};
    if (action == "ACTION_STOP" && showing_) {
      showing_->end = time;
      log_.shown.push_back(*std::exchange(showing_, std::nullopt));
    }
    return true;
  }

  std::string hand_, arm_, glove_;
  RecordingLog log_;
  std::map<std::string, Poses> seen_;
  std::optional<Attempt> running_, showing_;
};

/// The hand that is meant: the given one, or the only one that got commands.
Expected<std::string> hand_of(Reader& reader, const std::string& file, const std::string& wanted) {
  std::set<std::string> hands;
  RecordedMessages(reader).read([](const std::string& topic) { return topic == "robot/command"; },
                                [&](const std::string&, const Value& message, Time) {
                                  hands.insert(text(message, "hand"));
                                  return Expected<void>();
                                });
  std::string names;
  for (const std::string& hand : hands) names += (names.empty() ? "" : ", ") + printable(hand);
  if (hands.empty())
    return fail("holds no command of a hand, on robot/command", file,
                "choose a recording that does: prehend recording info FILE says what it holds",
                exit_no);
  if (wanted.empty() && hands.size() > 1)
    return wrong_use("holds several hands: " + names, file,
                     "choose one with --hand, or all as --hand NAME,NAME");
  if (!wanted.empty() && !hands.contains(wanted))
    return wrong_use("holds no hand " + wanted + " but " + names, file);
  return wanted.empty() ? *hands.begin() : wanted;
}

}  // namespace

Expected<ReadLog> read_log(const std::filesystem::path& file, const std::string& hand) {
  auto reader = open_recording(file);
  if (!reader) return tl::unexpected(reader.error());
  const auto name = hand_of(*reader, file.string(), hand);
  if (!name) return tl::unexpected(name.error());

  RecordedMessages messages(*reader);
  LogTaker taker(*name);
  messages.read([](const std::string& topic) { return LogTaker::topics().contains(topic); },
                [&](const std::string& topic, const Value& message, Time time) -> Expected<void> {
                  const auto take = LogTaker::topics().find(topic)->second;
                  if ((taker.*take)(message, time)) return {};
                  return fail("its values cannot be");
                });
  ReadLog read{taker.finish(), first_time(*reader), reader->contents().damage};
  for (Error& error : messages.damage()) read.damage.push_back(std::move(error));
  if (read.log.command_dof.empty())
    return fail("holds no command that can be used", file.string(), "", exit_no);
  if (!read.log.dof.empty() &&
      read.log.dof.values.front().size() != read.log.command_dof.values.front().size())
    return fail("its robot/command and robot/state are of different hands", file.string(), "",
                exit_no);
  return read;
}

Expected<std::vector<std::filesystem::path>> recordings_of(
    const std::vector<std::string>& sources) {
  std::vector<std::filesystem::path> all;
  for (const std::string& source : sources) {
    std::error_code problem;
    if (!std::filesystem::is_directory(source, problem)) {
      if (!std::filesystem::exists(source, problem)) return fail("is not there", source);
      all.emplace_back(source);
      continue;
    }
    std::vector<std::filesystem::path> found;
    for (std::filesystem::recursive_directory_iterator each(source, problem), end;
         !problem && each != end; each.increment(problem))
      if (each->path().extension() == ".mcap" && each->is_regular_file(problem))
        found.push_back(each->path());
    if (problem) return fail(problem.message(), source);
    if (found.empty()) return fail("holds no recording (*.mcap)", source, "", exit_no);
    std::ranges::sort(found);
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

}  // namespace prehend::recorder::dataset
