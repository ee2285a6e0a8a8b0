#include "services/recorder/core/dataset/hands.hpp"

#include <algorithm>

namespace prehend::recorder::dataset {
namespace {

void append(Table& to, const Table& columns) {
  const Eigen::Index before = to.cols();
  to.conservativeResize(columns.rows(), before + columns.cols());
  to.rightCols(columns.cols()) = columns;
}

void append(Feature& to, const Feature& of_one, const std::string& prefix) {
  append(to.values, of_one.values);
  for (const std::string& column : of_one.columns) to.columns.push_back(prefix + column);
}

/// All of the same rows.
Rows side_by_side(const std::vector<HandLog>& hands, std::vector<Rows> of_each) {
  Rows all;
  all.begin = of_each.front().begin;
  all.count = of_each.front().count;
  all.state.name = of_each.front().state.name;
  all.action.name = of_each.front().action.name;
  all.pictures = std::move(of_each.front().pictures);
  const bool effort =
      std::ranges::all_of(of_each, [](const Rows& rows) { return rows.effort.cols() > 0; });
  for (std::size_t i = 0; i < hands.size(); ++i) {
    const std::string prefix = hands[i].name + "_";
    Rows& rows = of_each[i];
    append(all.state, rows.state, prefix);
    append(all.action, rows.action, prefix);
    append(all.rate, rows.rate);
    if (effort) append(all.effort, rows.effort);
    for (Feature& feature : rows.others) {
      const bool own = feature.about == About::robot || feature.about == About::human;
      if (own) feature.name = prefix + feature.name;
      if (own || i == 0) all.others.push_back(std::move(feature));
    }
  }
  return all;
}

}  // namespace

std::vector<Episode> find_episodes(const std::vector<HandLog>& hands) {
  const RecordingLog& first = *hands.front().log;
  if (hands.size() == 1) return find_episodes(first);
  Time begin = Time::min(), end = Time::max();
  RecordingLog all;
  for (const HandLog& each : hands) {
    const RecordingLog& log = *each.log;
    if (log.command_dof.empty()) return {};
    begin = std::max(begin, log.command_dof.times.front());
    end = std::min(end, log.command_dof.times.back());
    all.runs.insert(all.runs.end(), log.runs.begin(), log.runs.end());
    all.judgements.insert(all.judgements.end(), log.judgements.begin(), log.judgements.end());
  }
  if (begin >= end) return {};
  all.command_dof.add(begin, {});
  all.command_dof.add(end, {});
  all.command_object = first.command_object;
  all.shown = first.shown;
  std::ranges::sort(all.runs, {}, &Attempt::begin);
  std::ranges::sort(all.judgements, {}, &Judgement::time);
  return find_episodes(all);
}

Expected<Rows> make_rows(const std::vector<HandLog>& hands, const Episode& episode,
                         const RowOptions& options) {
  Episode common = episode;
  // Who is told of late lets the others wait; what they wait for may come later still.
  for (std::size_t tried = 0; tried <= hands.size(); ++tried) {
    std::vector<Rows> of_each;
    for (const HandLog& each : hands) {
      RowOptions own = options;
      own.hand = each.hand;
      auto rows = make_rows(*each.log, common, own);
      if (!rows && hands.size() > 1) rows.error().what = each.name + ": " + rows.error().what;
      if (!rows) return rows;
      of_each.push_back(std::move(*rows));
    }
    if (hands.size() == 1) return std::move(of_each.front());
    for (const Rows& rows : of_each) common.begin = std::max(common.begin, rows.begin);
    if (std::ranges::all_of(of_each, [&](const Rows& rows) { return rows.begin == common.begin; }))
      return side_by_side(hands, std::move(of_each));
  }
  return fail("what is told of its hands has no time in common", "",
              "export each hand by itself: --hand NAME");
}

}  // namespace prehend::recorder::dataset
