#include "services/demonstration/core/segmentation/semi_markov.hpp"

#include <algorithm>
#include <limits>

namespace prehend::demonstration {

namespace {

constexpr double impossible = -std::numeric_limits<double>::infinity();

Expected<void> check(const Eigen::MatrixXd& scores, const SemiMarkovOptions& options) {
  const Eigen::Index n = options.log_initial.size();
  if (n == 0 || scores.rows() != n || options.log_transition.rows() != n ||
      options.log_transition.cols() != n || options.min_length.size() != n ||
      options.max_length.size() != n)
    return fail("sizes of a semi-Markov model do not fit each other");
  if (options.min_length.minCoeff() < 1 || (options.max_length - options.min_length).minCoeff() < 0)
    return fail("a state's lengths are upside down or below 1");
  if (scores.hasNaN()) return fail("a sample's score is no number");
  return {};
}

/// Of the best path in which a state ends at a time.
struct Ending {
  double log = impossible;
  Eigen::Index begin = 0;  // of the state
  int before = -1;         // state before it; -1: it is the first
};

}  // namespace

Expected<SemiMarkovPath> decode(const Eigen::MatrixXd& scores, const SemiMarkovOptions& options) {
  if (auto ok = check(scores, options); !ok) return tl::unexpected(ok.error());
  const Eigen::Index length = scores.cols();
  const auto n = static_cast<int>(scores.rows());
  if (length == 0) return SemiMarkovPath{};
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(n, length + 1);  // of the scores before a sample
  for (Eigen::Index t = 0; t < length; ++t) sums.col(t + 1) = sums.col(t) + scores.col(t);
  // entry: the best way into a state that begins at a sample, and the state before it.
  Eigen::MatrixXd entry = Eigen::MatrixXd::Constant(n, length, impossible);
  Eigen::MatrixXi from = Eigen::MatrixXi::Constant(n, length, -1);
  entry.col(0) = options.log_initial;
  std::vector<std::vector<Ending>> endings(static_cast<std::size_t>(length),
                                           std::vector<Ending>(static_cast<std::size_t>(n)));
  for (Eigen::Index end = 1; end <= length; ++end) {
    auto& here = endings[static_cast<std::size_t>(end - 1)];
    for (int s = 0; s < n; ++s) {
      Ending& best = here[static_cast<std::size_t>(s)];
      const auto first = std::max<Eigen::Index>(0, end - options.max_length[s]);
      for (Eigen::Index begin = first; begin < end; ++begin) {
        const bool cut = begin == 0 || end == length;
        if (!cut && end - begin < options.min_length[s]) break;
        const double log = entry(s, begin) + sums(s, end) - sums(s, begin);
        if (log > best.log) best = {log, begin, from(s, begin)};
      }
    }
    if (end == length) break;
    for (int to = 0; to < n; ++to)
      for (int s = 0; s < n; ++s) {
        const double log = here[static_cast<std::size_t>(s)].log + options.log_transition(s, to);
        if (log > entry(to, end)) entry(to, end) = log, from(to, end) = s;
      }
  }
  const auto& last = endings.back();
  const auto best = std::max_element(
      last.begin(), last.end(), [](const Ending& a, const Ending& b) { return a.log < b.log; });
  if (best->log == impossible) return fail("no permitted order of states explains the samples");
  SemiMarkovPath path{{}, best->log};
  Eigen::Index end = length;
  for (auto state = static_cast<int>(best - last.begin()); state >= 0;) {
    const Ending& ending =
        endings[static_cast<std::size_t>(end - 1)][static_cast<std::size_t>(state)];
    path.stretches.push_back({state, ending.begin, end});
    end = ending.begin;
    state = ending.before;
  }
  std::reverse(path.stretches.begin(), path.stretches.end());
  return path;
}

}  // namespace prehend::demonstration
