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

/// By which hand a grasp was judged.
struct OfHand {
  Judgement judgement;
  std::size_t hand;
};

/// In order of time; what several hands have judged of one object is one judgement, until `end`.
std::vector<Judgement> together(std::vector<OfHand> judged, Time end) {
  std::ranges::stable_sort(judged, {}, [](const OfHand& one) { return one.judgement.time; });
  std::vector<Judgement> all;
  std::size_t hand = 0;  // that the last of them is of
  for (const OfHand& each : judged) {
    const bool same = !all.empty() && all.back().object == each.judgement.object;
    if (same && (all.back().until || hand != each.hand)) {
      all.back() = {each.judgement.time, each.judgement.object,
                    all.back().held && each.judgement.held, end};
    } else {
      all.push_back(each.judgement);
    }
    hand = each.hand;
  }
  return all;
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
  std::vector<OfHand> judged;
  for (std::size_t i = 0; i < hands.size(); ++i) {
    const RecordingLog& log = *hands[i].log;
    if (log.command_dof.empty()) return {};
    begin = std::max(begin, log.command_dof.times.front());
    end = std::min(end, log.command_dof.times.back());
    all.runs.insert(all.runs.end(), log.runs.begin(), log.runs.end());
    for (const Judgement& judgement : log.judgements) judged.push_back({judgement, i});
  }
  if (begin >= end) return {};
  all.command_dof.add(begin, {});
  all.command_dof.add(end, {});
  all.command_object = first.command_object;
  all.shown = first.shown;
  std::ranges::sort(all.runs, {}, &Attempt::begin);
  all.judgements = together(std::move(judged), end);
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
