#include "services/recorder/core/dataset/mapped_log.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "services/recorder/core/dataset/pose_columns.hpp"

namespace prehend::recorder::dataset {
namespace {

/// When actions were told, in order.
std::vector<Time> action_times(const MappedLog& log) {
  std::vector<Time> all;
  for (const Track& track : log.tracks)
    if (track.role == Role::action) {
      std::vector<Time> merged;
      std::ranges::merge(all, track.times(), std::back_inserter(merged));
      all = std::move(merged);
    }
  return all;
}

std::vector<Episode> by_marks(const MappedLog& log, const EpisodeRule& rule, Time last) {
  std::vector<Episode> episodes;
  std::optional<Time> begin;
  for (const Mark& mark : log.marks) {
    if (mark.ends && begin) episodes.push_back({*begin, mark.time, rule.task, "", mark.success});
    if (mark.ends) begin.reset();
    if (mark.begins && !begin) begin = mark.time;
  }
  if (begin && *begin < last) episodes.push_back({*begin, last, rule.task, "", std::nullopt});
  return episodes;
}

std::vector<Episode> by_gaps(const std::vector<Time>& times, const EpisodeRule& rule) {
  std::vector<Episode> episodes;
  Time begin = times.front(), before = begin;
  for (const Time time : times) {
    if (rule.gap > Duration::zero() && time - before > rule.gap) {
      episodes.push_back({begin, before, rule.task, "", std::nullopt});
      begin = time;
    }
    before = time;
  }
  episodes.push_back({begin, before, rule.task, "", std::nullopt});
  return episodes;
}

/// Rows of one episode, track by track.
class MappedRows {
 public:
  MappedRows(const MappedLog& log, const Episode& episode, const RowOptions& options)
      : log_(log), episode_(episode), options_(options) {}

  Expected<Rows> make() {
    if (auto found = find_begin(); !found) return tl::unexpected(found.error());
    const double duration = to_seconds(episode_.end - begin_);
    rows_.count =
        static_cast<Eigen::Index>(std::floor(std::min(duration * options_.rate, 1e12) + 1e-6)) + 1;
    if (duration <= 0 || rows_.count < 2) return fail("an episode is shorter than two rows");
    if (rows_.count > max_rows)
      return fail("an episode is of more than a million rows", "", "are its times right?");
    rows_.begin = begin_;
    rows_.state = {"state", About::robot, {}, Table(rows_.count, 0)};
    rows_.action = {"action", About::robot, {}, Table(rows_.count, 0)};
    for (const Track& track : log_.tracks) add(track);
    for (const auto& [name, camera] : log_.cameras)
      for (Eigen::Index row = 0; row < rows_.count; ++row)
        rows_.pictures[name].push_back(newest(camera.times, moment(row)));
    rows_.rate = rates();
    return std::move(rows_);
  }

 private:
  Time moment(Eigen::Index row) const {
    return begin_ + seconds(static_cast<double>(row) / options_.rate);
  }

  /// What was told at most `max_wait` before the episode is known when it begins.
  Expected<void> wait_for(const std::vector<Time>& times, const std::string& name) {
    const auto after = std::ranges::upper_bound(times, episode_.begin);
    if (after != times.begin() && *std::prev(after) >= episode_.begin - max_wait) return {};
    if (after == times.end() || *after > episode_.end)
      return fail(name + " is not told in an episode");
    begin_ = std::max(begin_, *after);
    return {};
  }

  Expected<void> find_begin() {
    begin_ = episode_.begin;
    for (const Track& track : log_.tracks)
      if (auto heard = wait_for(track.times(), track.name); !heard) return heard;
    for (const auto& [name, camera] : log_.cameras)
      if (auto heard = wait_for(camera.times, name); !heard) return heard;
    return {};
  }

  Feature feature_of(const Track& track) const {
    Feature made{track.name, About::robot, track.columns, {}};
    const bool is_pose = !track.poses.empty();
    if (is_pose) {
      const std::string before = track.columns.empty() ? "" : track.columns.front() + ".";
      made.columns = pose_columns(options_.turns);
      for (std::string& column : made.columns) column = before + column;
    }
    made.values.resize(rows_.count, static_cast<Eigen::Index>(made.columns.size()));
    PoseWriter writer(options_.turns);
    for (Eigen::Index row = 0; row < rows_.count; ++row)
      made.values.row(row) =
          (is_pose ? writer.numbers(at(track.poses, moment(row))) : at(track.numbers, moment(row)))
              .transpose();
    return made;
  }

  void add(const Track& track) {
    Feature made = feature_of(track);
    if (track.role == Role::observation) {
      rows_.others.push_back(std::move(made));
      return;
    }
    Feature& whole = track.role == Role::state ? rows_.state : rows_.action;
    Table wider(rows_.count, whole.values.cols() + made.values.cols());
    wider << whole.values, made.values;
    whole.values = std::move(wider);
    whole.columns.insert(whole.columns.end(), made.columns.begin(), made.columns.end());
  }

  Table rates() const {
    const Table& state = rows_.state.values;
    Table made(state.rows(), state.cols());
    const Eigen::Index last = rows_.count - 1;
    for (Eigen::Index row = 0; row <= last; ++row) {
      const Eigen::Index before = std::max<Eigen::Index>(row - 1, 0),
                         after = std::min(row + 1, last);
      made.row(row) = (state.row(after) - state.row(before)) * options_.rate /
                      static_cast<double>(after - before);
    }
    return made;
  }

  const MappedLog& log_;
  const Episode& episode_;
  const RowOptions& options_;
  Time begin_{};
  Rows rows_;
};

}  // namespace

std::vector<Episode> given_episodes(const std::vector<std::pair<double, double>>& given, Time start,
                                    const std::string& task) {
  std::vector<Episode> episodes;
  for (const auto& [from, to] : given)
    episodes.push_back({start + seconds(from), start + seconds(to), task, "", std::nullopt});
  return episodes;
}

std::vector<Episode> find_episodes(const MappedLog& log, const EpisodeRule& rule, Time start) {
  if (!rule.given.empty()) return given_episodes(rule.given, start, rule.task);
  const std::vector<Time> times = action_times(log);
  if (times.empty()) return {};
  if (!log.marks.empty()) return by_marks(log, rule, times.back());
  return by_gaps(times, rule);
}

Expected<Rows> make_rows(const MappedLog& log, const Episode& episode, const RowOptions& options) {
  return MappedRows(log, episode, options).make();
}

}  // namespace prehend::recorder::dataset
