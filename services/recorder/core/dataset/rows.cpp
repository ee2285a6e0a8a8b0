#include "services/recorder/core/dataset/rows.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "services/recorder/core/dataset/pose_columns.hpp"

namespace prehend::recorder::dataset {
namespace {

using Columns = std::vector<std::string>;

Columns with_prefix(const std::string& prefix, const Columns& columns) {
  Columns all;
  for (const std::string& column : columns) all.push_back(prefix + column);
  return all;
}

Columns with_axes(const Columns& points) {
  Columns all;
  for (const std::string& point : points)
    for (const char* axis : {".x", ".y", ".z"}) all.push_back(point + axis);
  return all;
}

/// Rows of one episode, feature by feature.
class RowMaker {
 public:
  RowMaker(const RecordingLog& log, const Episode& episode, const RowOptions& options)
      : log_(log), episode_(episode), options_(options) {}

  Expected<Rows> make() {
    if (log_.dof.empty() || log_.dof.times.front() > episode_.end)
      return fail("says nothing of where the hand is (robot/state)");
    begin_ = std::max({episode_.begin, log_.command_dof.times.front(), log_.dof.times.front()});
    wait_for_others();
    const double duration = to_seconds(episode_.end - begin_);
    rows_.count = static_cast<Eigen::Index>(std::floor(duration * options_.rate + 1e-6)) + 1;
    if (duration <= 0 || rows_.count < 2) return fail("an episode is shorter than two rows");
    if (rows_.count > max_rows)
      return fail("an episode is of more than a million rows", "", "are its times right?");
    rows_.begin = begin_;
    hand();
    around();
    for (const auto& [name, camera] : log_.cameras) {
      if (!there(camera.times)) continue;
      for (Eigen::Index row = 0; row < rows_.count; ++row)
        rows_.pictures[name].push_back(newest(camera.times, moment(row)));
    }
    return std::move(rows_);
  }

 private:
  Time moment(Eigen::Index row) const {
    return begin_ + seconds(static_cast<double>(row) / options_.rate);
  }

  /// From when on it is known what a topic says: at once where it was heard shortly before the
  /// commands and states begin. Nothing: not in this episode.
  std::optional<Time> known_from(const std::vector<Time>& times) const {
    if (times.empty()) return std::nullopt;
    const Time before = times[newest(times, earliest_)];
    if (before <= earliest_ && before >= earliest_ - max_wait) return earliest_;
    const auto later = std::ranges::upper_bound(times, earliest_);
    if (later == times.end() || *later > earliest_ + max_wait) return std::nullopt;
    return *later;
  }
  bool there(const std::vector<Time>& times) const { return known_from(times).has_value(); }

  void wait_for_others() {
    earliest_ = begin_;
    const auto wait = [&](const std::vector<Time>& times) {
      begin_ = std::max(begin_, known_from(times).value_or(begin_));
    };
    for (const Numbers* series : {&log_.human_fingertips, &log_.arm_joint, &log_.touch_force})
      wait(series->times);
    for (const auto& [name, poses] : log_.objects) wait(poses.times);
    for (const auto& [name, camera] : log_.cameras) wait(camera.times);
  }

  Table table(const std::function<Eigen::VectorXd(Time)>& numbers) const {
    Table all;
    for (Eigen::Index row = 0; row < rows_.count; ++row) {
      const Eigen::VectorXd values = numbers(moment(row));
      if (row == 0) all.resize(rows_.count, values.size());
      all.row(row) = values.transpose();
    }
    return all;
  }

  Table dof_and_base(const Numbers& dof, const Poses& X_WB) const {
    PoseWriter writer(options_.turns);
    return table([&](Time t) {
      const Eigen::VectorXd fingers = at(dof, t), base = writer.numbers(at(X_WB, t));
      Eigen::VectorXd all(fingers.size() + base.size());
      all << fingers, base;
      return all;
    });
  }

  Columns names(const std::string& what, Eigen::Index count) const {
    Columns all;
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const auto* hand = options_.hand;
      if (hand && what == "dof" && k < hand->dofs().size())
        all.push_back(hand->dofs()[k].name);
      else if (hand && what == "joint" && k < hand->joints().size())
        all.push_back(hand->joints()[k].name);
      else
        all.push_back(what + std::to_string(i));
    }
    return all;
  }

  void hand() {
    rows_.state = {"state", About::robot, {}, dof_and_base(log_.dof, log_.X_WB)};
    rows_.action = {"action", About::robot, {}, dof_and_base(log_.command_dof, log_.command_X_WB)};
    const Columns base = with_prefix("base.", pose_columns(options_.turns));
    const Eigen::Index dofs = rows_.state.values.cols() - static_cast<Eigen::Index>(base.size());
    Columns columns = names("dof", dofs);
    columns.insert(columns.end(), base.begin(), base.end());
    rows_.state.columns = rows_.action.columns = columns;

    add("joint_position", About::robot, names("joint", width(log_.joint)), log_.joint);
    add("joint_velocity", About::robot, names("joint", width(log_.velocity)), log_.velocity);
    add("joint_torque", About::robot, names("joint", width(log_.torque)), log_.torque);
    add("touch_force", About::robot, with_axes(log_.touch_links), log_.touch_force);
    add("touch_pressure", About::robot, log_.touch_links, log_.touch_pressure);
    add("touch_slip", About::robot, log_.touch_links, log_.touch_slip);
    fingertips();
    drives(dofs);
  }

  static Eigen::Index width(const Numbers& series) {
    return series.empty() ? 0 : series.values.front().size();
  }

  void add(std::string name, About about, Columns columns, const Numbers& series) {
    if (width(series) == 0 || !there(series.times)) return;
    rows_.others.push_back(
        {std::move(name), about, std::move(columns), table([&](Time t) { return at(series, t); })});
  }

  /// In W, of the measured joints.
  void fingertips() {
    const auto* hand = options_.hand;
    if (!hand || width(log_.joint) != static_cast<Eigen::Index>(hand->joints().size())) return;
    Columns tips;
    for (const auto& tip : hand->fingertips()) tips.push_back(tip.name);
    const Columns columns = with_axes(tips);
    rows_.others.push_back({"fingertips", About::robot, columns, table([&](Time t) {
                              const auto X_BL = hand->link_poses(at(log_.joint, t));
                              const Pose X_WB = at(log_.X_WB, t);
                              Eigen::VectorXd all(static_cast<Eigen::Index>(columns.size()));
                              Eigen::Index i = 0;
                              for (const auto& tip : hand->fingertips()) {
                                all.segment<3>(i) =
                                    X_WB * X_BL[static_cast<std::size_t>(tip.link)] * tip.p_LT;
                                i += 3;
                              }
                              return all;
                            })});
  }

  /// The joint that leads each DoF, where that is known.
  std::vector<Eigen::Index> leads(Eigen::Index dofs) const {
    std::vector<Eigen::Index> all;
    for (Eigen::Index i = 0; i < dofs; ++i) {
      if (options_.hand && dofs == static_cast<Eigen::Index>(options_.hand->dofs().size()))
        all.push_back(options_.hand->dofs()[static_cast<std::size_t>(i)].joint);
      else if (dofs == width(log_.joint))
        all.push_back(i);
    }
    return all;
  }

  /// Rates by differences; those of drives as they were measured. Nobody measures the base.
  void drives(Eigen::Index dofs) {
    const Table& state = rows_.state.values;
    const Eigen::Index last = rows_.count - 1;
    rows_.rate = Table::Zero(rows_.count, state.cols());
    for (Eigen::Index row = 0; row <= last; ++row) {
      const Eigen::Index before = std::max<Eigen::Index>(row - 1, 0),
                         after = std::min(row + 1, last);
      rows_.rate.row(row) = (state.row(after) - state.row(before)) * options_.rate /
                            static_cast<double>(after - before);
    }
    const auto lead = leads(dofs);
    const auto fits = [&](const Numbers& series) {
      return !lead.empty() &&
             std::ranges::all_of(lead, [&](Eigen::Index joint) { return joint < width(series); });
    };
    const bool velocity = fits(log_.velocity), torque = fits(log_.torque);
    if (torque) rows_.effort = Table::Zero(rows_.count, state.cols());
    for (Eigen::Index row = 0; row <= last; ++row) {
      for (std::size_t i = 0; i < lead.size(); ++i) {
        const auto column = static_cast<Eigen::Index>(i);
        if (velocity) rows_.rate(row, column) = at(log_.velocity, moment(row))[lead[i]];
        if (torque) rows_.effort(row, column) = at(log_.torque, moment(row))[lead[i]];
      }
    }
  }

  void around() {
    add("arm_position", About::arm, names("arm", width(log_.arm_joint)), log_.arm_joint);
    add("arm_velocity", About::arm, names("arm", width(log_.arm_velocity)), log_.arm_velocity);
    add("human_fingertips", About::human, with_axes(log_.human_fingers), log_.human_fingertips);
    if (const auto found = log_.objects.find(episode_.object); found != log_.objects.end())
      add_object("object", found->second);
    for (const auto& [name, poses] : log_.objects) add_object("object_" + name, poses);
  }

  void add_object(std::string name, const Poses& poses) {
    if (!there(poses.times)) return;
    PoseWriter writer(options_.turns);
    rows_.others.push_back({std::move(name), About::object, pose_columns(options_.turns),
                            table([&](Time t) { return writer.numbers(at(poses, t)); })});
  }

  const RecordingLog& log_;
  const Episode& episode_;
  const RowOptions& options_;
  Time begin_, earliest_;
  Rows rows_;
};

}  // namespace

Expected<Rows> make_rows(const RecordingLog& log, const Episode& episode,
                         const RowOptions& options) {
  return RowMaker(log, episode, options).make();
}

}  // namespace prehend::recorder::dataset
