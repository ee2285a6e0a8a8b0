#include "services/demonstration/tools/evaluation/judged.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/statistics/intervals.hpp"

namespace prehend::demonstration {

namespace {

double share_of(const std::vector<Judged>& grasps, const auto& counts) {
  if (grasps.empty()) return 0;
  return static_cast<double>(std::count_if(grasps.begin(), grasps.end(), counts)) /
         static_cast<double>(grasps.size());
}

}  // namespace

std::size_t Judged::best() const {
  Eigen::Index at = 0;
  answer.maxCoeff(&at);
  return static_cast<std::size_t>(at);
}

double accuracy(const std::vector<Judged>& grasps) {
  return share_of(grasps, [](const Judged& grasp) { return grasp.right(); });
}

double brier(const std::vector<Judged>& grasps) {
  double sum = 0;
  for (const Judged& grasp : grasps) {
    Eigen::VectorXd off = grasp.answer;
    off[static_cast<Eigen::Index>(grasp.truth)] -= 1;
    sum += off.squaredNorm();
  }
  return grasps.empty() ? 0 : sum / static_cast<double>(grasps.size());
}

double accuracy_at(const std::vector<Judged>& grasps, double coverage) {
  std::vector<Judged> surest = grasps;
  std::stable_sort(surest.begin(), surest.end(),
                   [](const Judged& a, const Judged& b) { return a.sureness() > b.sureness(); });
  surest.resize(static_cast<std::size_t>(std::ceil(coverage * static_cast<double>(grasps.size()))));
  return accuracy(surest);
}

double accuracy_after(const std::vector<Judged>& grasps, double share) {
  return share_of(grasps, [&](const Judged& grasp) {
    if (grasp.stream.empty()) return grasp.right();
    const auto seen = std::ceil(share * static_cast<double>(grasp.stream.size()));
    return grasp.stream[static_cast<std::size_t>(std::max(1.0, seen)) - 1] == grasp.truth;
  });
}

std::vector<std::vector<int>> confusion(const std::vector<Judged>& grasps, std::size_t classes) {
  std::vector<std::vector<int>> counts(classes, std::vector<int>(classes, 0));
  for (const Judged& grasp : grasps) ++counts[grasp.truth][grasp.best()];
  return counts;
}

std::array<Bin, 10> reliability(const std::vector<Judged>& grasps) {
  std::array<Bin, 10> bins{};
  for (const Judged& grasp : grasps) {
    const double said = grasp.sureness();
    Bin& bin = bins[std::min<std::size_t>(9, static_cast<std::size_t>(10 * said))];
    bin.said += said;
    bin.held += grasp.right();
    ++bin.count;
  }
  for (Bin& bin : bins)
    if (bin.count > 0) {
      bin.said /= static_cast<double>(bin.count);
      bin.held /= static_cast<double>(bin.count);
    }
  return bins;
}

double family_accuracy(const std::vector<Judged>& grasps, const std::vector<std::size_t>& family) {
  return share_of(grasps,
                  [&](const Judged& grasp) { return family[grasp.best()] == family[grasp.truth]; });
}

double deviation_between_people(const std::vector<Judged>& grasps) {
  std::map<std::string, std::vector<Judged>> people;
  for (const Judged& grasp : grasps) people[grasp.user].push_back(grasp);
  std::vector<double> accuracies;
  for (const auto& [user, own] : people) accuracies.push_back(accuracy(own));
  return statistics::deviation(accuracies);
}

}  // namespace prehend::demonstration
