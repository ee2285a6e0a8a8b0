#include "services/planner/tools/planning/grasp_class.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace prehend::planner {

namespace {

constexpr double one_sided = 0.2;       // opposing, below: all press from one side
constexpr double circle = 0.35;         // around, above: fingers press from more than two sides
constexpr double along_approach = 0.7;  // cosine, above: the circle lies around the way of the palm
constexpr double no_width = 0.001;      // m

/// Which fingers touch, and whether more than their tips do.
Expected<void> read_touches(const model::HandModel& hand,
                            const std::vector<analysis::Contact>& contacts, GraspLooks& made) {
  std::set<int> fingers;
  for (const analysis::Contact& contact : contacts) {
    const auto& links = hand.links();
    const auto link = std::find_if(links.begin(), links.end(), [&](const model::HandLink& one) {
      return one.name == contact.link;
    });
    if (link == links.end())
      return fail(fmt::format("the hand {} has no link «{}»", hand.name(), contact.link));
    const auto number = static_cast<int>(link - links.begin());
    if (link->finger < 0 ||
        hand.fingertips()[static_cast<std::size_t>(link->finger)].link != number)
      made.enclosed = true;
    if (link->finger >= 0) fingers.insert(link->finger);
  }
  made.fingers = static_cast<int>(fingers.size());
  return {};
}

/// Which way contacts press.
model::GraspForm read_forces(const std::vector<analysis::Contact>& contacts,
                             const Eigen::Vector3d& approach_O, GraspLooks& made) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const analysis::Contact& contact : contacts) {
    scatter += contact.normal_O * contact.normal_O.transpose();
    sum += contact.normal_O;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  const Eigen::Vector3d most = solver.eigenvectors().col(2), least = solver.eigenvectors().col(0);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const analysis::Contact& contact : contacts) {
    low = std::min(low, most.dot(contact.p_OC));
    high = std::max(high, most.dot(contact.p_OC));
  }
  made.width = high - low;
  made.opposing = 1 - sum.norm() / static_cast<double>(contacts.size());
  made.around = solver.eigenvalues()[1] / solver.eigenvalues()[2];
  if (made.opposing < one_sided) return model::GraspForm::flat;
  const bool from_everywhere = solver.eigenvalues()[0] > circle * solver.eigenvalues()[2];
  const bool in_line = std::abs(least.dot(approach_O.normalized())) > along_approach;
  return made.around > circle && (from_everywhere || in_line) ? model::GraspForm::circular
                                                              : model::GraspForm::prismatic;
}

/// How badly a class fits beyond its kind and form.
double misfit(const model::GraspClass& one, const GraspLooks& looks,
              const std::optional<model::Shape>& shape) {
  const double nearest = std::clamp(looks.width, one.min_width, one.max_width);
  double sum = std::abs(std::log2(std::max(looks.width, no_width) / nearest));
  // Of equal fits the range in whose middle the width lies.
  sum += 0.01 * std::abs(std::log2(std::max(looks.width, no_width) /
                                   std::sqrt(one.min_width * one.max_width)));
  if (shape && std::find(one.shapes.begin(), one.shapes.end(), shape->kind) == one.shapes.end())
    sum += 3;
  if (!looks.enclosed)
    sum += 10 * std::abs(static_cast<int>(one.opposed.size()) - std::max(1, looks.fingers - 1));
  return sum;
}

}  // namespace

Expected<GraspLooks> looks_of(const model::HandModel& hand,
                              const std::vector<analysis::Contact>& contacts,
                              const Eigen::Vector3d& approach_O,
                              const std::optional<model::Shape>& shape,
                              const model::GraspTaxonomy& taxonomy) {
  if (contacts.empty()) return fail("a grasp without contacts is of no kind");
  GraspLooks made;
  if (auto ok = read_touches(hand, contacts, made); !ok) return tl::unexpected(ok.error());
  made.form = read_forces(contacts, approach_O, made);
  const bool flat = made.form == model::GraspForm::flat;
  made.kind = made.enclosed || flat ? model::GraspKind::power : model::GraspKind::precision;
  double least = std::numeric_limits<double>::infinity();
  for (const model::GraspClass& one : taxonomy.classes()) {
    if (one.kind != made.kind || one.form != made.form || one.thumb == model::ThumbPlace::adducted)
      continue;
    const double off = misfit(one, made, shape);
    if (off < least) least = off, made.name = one.name;
  }
  if (made.name.empty()) return fail("no class of the taxonomy is of this kind and form");
  return made;
}

}  // namespace prehend::planner
