#include "services/demonstration/core/person/person.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/motion.hpp"
#include "common/model/human_grasp.hpp"

namespace prehend::demonstration {

namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double straight_in = 0.12;                   // m, of the last part of a reach
constexpr double rest_back = 0.30, rest_above = 0.20;  // m
constexpr double via = 0.15;                           // m, that an object is lifted
constexpr double relaxed = 0.25;                       // closure of a hand that does nothing

/// So far along a line with corners, by length.
Pose along(const std::vector<Pose>& way, double share) {
  double length = 0;
  for (std::size_t i = 1; i < way.size(); ++i)
    length += (way[i].translation() - way[i - 1].translation()).norm();
  double left = share * length;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const double part = (way[i].translation() - way[i - 1].translation()).norm();
    if (left <= part && part > 0) return interpolate(way[i - 1], way[i], left / part);
    left -= part;
  }
  return way.back();
}

/// Where a hand comes from: behind the wrist.
Vector3d back_of(const Pose& X_WG) {
  Vector3d back = -X_WG.linear().col(2);
  if (std::abs(back.z()) > 0.7) back = -X_WG.linear().col(1);
  back.z() = 0;
  return back.normalized();
}

}  // namespace

Person::Person(const model::Scene& scene)
    : demonstrator_(scene.demonstrator), hand_(scene.demonstrator.hand_scale) {}

void Person::pass(Phase phase, double duration, const std::string& object) {
  truth_.push_back({phase, now_, now_ + duration, object});
  now_ += duration;
}

Expected<void> Person::take(const Transfer& transfer, Random& random) {
  const auto found = std::find_if(things_.begin(), things_.end(),
                                  [&](const Thing& each) { return each.name == transfer.object; });
  if (found == things_.end())
    return fail("'" + transfer.object + "' is not in the scene", "person", "name one that is");
  const auto number = static_cast<std::size_t>(found - things_.begin());
  const Pose X_WO = objects(now_)[number].X_WO;
  const auto X_OG = model::human_grasp(found->shape, X_WO, demonstrator_);
  if (!X_OG)
    return fail("'" + transfer.object + "' is too large for the person's hand", "person",
                "choose another object");
  const Pose X_WG = X_WO * *X_OG, X_WH = X_WG * hand_.X_HG().inverse();
  const auto closure = hand_.close_on(found->shape, X_WH.inverse() * X_WO);
  const Vector3d approach = X_WG.linear().col(2), up = Vector3d::UnitZ();
  const Pose X_WH_before = moved(X_WH, -straight_in * approach);
  const Pose X_WO_after = make_pose(
      transfer.to, Matrix3d(AngleAxisd(transfer.turn, up).toRotationMatrix() * X_WO.linear()));
  const Pose X_HO = X_WH.inverse() * X_WO;
  const Pose X_WH_put = X_WO_after * X_HO.inverse();
  const double height = via + std::max(0.0, X_WH_put.translation().z() - X_WH.translation().z());
  const double over = height - X_WH_put.translation().z() + X_WH.translation().z();
  if (moves_.empty() && truth_.empty()) {
    X_WH_rest_ = moved(X_WH, rest_back * back_of(X_WG) + rest_above * up);
    pass(Phase::rest, random.uniform(0.8, 1.2));
  }
  std::array<double, model::finger_count> open{}, loose{};
  loose.fill(relaxed);

  const double reach = random.uniform(1.3, 1.7), closing = random.uniform(0.5, 0.7);
  moves_.push_back({now_, now_ + reach, {hand(now_).X_WH, X_WH_before, X_WH}});
  squeezes_.push_back({now_, now_ + 0.6 * reach, loose, open});
  pass(Phase::approach, reach);
  squeezes_.push_back({now_, now_ + closing, open, closure});
  pass(Phase::close, closing, transfer.object);
  const double before = random.uniform(0.2, 0.4), carry = random.uniform(1.6, 2.2),
               after = random.uniform(0.2, 0.4);
  moves_.push_back({now_ + before,
                    now_ + before + carry,
                    {X_WH, moved(X_WH, height * up), moved(X_WH_put, over * up), X_WH_put}});
  const double opening = random.uniform(0.35, 0.5);
  carries_.push_back({now_, now_ + before + carry + after, number, X_HO});
  pass(Phase::hold, before + carry + after, transfer.object);
  squeezes_.push_back({now_, now_ + opening, closure, open});
  pass(Phase::release, opening, transfer.object);
  const Vector3d away = X_WH_put.linear() * X_WH.linear().transpose() * approach;
  const double retract = random.uniform(1.2, 1.5);
  moves_.push_back(
      {now_, now_ + retract, {X_WH_put, moved(X_WH_put, -straight_in * away), X_WH_rest_}});
  squeezes_.push_back({now_ + 0.3 * retract, now_ + retract, open, loose});
  pass(Phase::retract, retract);
  pass(Phase::rest, random.uniform(0.8, 1.2));
  return {};
}

Expected<Person> Person::create(const model::Scene& scene, const model::Catalogue& catalogue,
                                const std::vector<Transfer>& transfers, std::uint64_t seed) {
  if (transfers.empty()) return fail("shows nothing", "person", "name what is put where");
  Person made(scene);
  for (const model::PlacedObject& placed : scene.objects) {
    const model::CatalogueObject* known = catalogue.find(placed.name);
    if (!known) return fail("'" + placed.name + "' is not in the catalogue", "person");
    made.things_.push_back({placed.name, known->shape, placed.X_WO});
  }
  Random random(seed);
  for (const Transfer& transfer : transfers)
    if (auto taken = made.take(transfer, random); !taken) return tl::unexpected(taken.error());
  return made;
}

Person::HandThen Person::hand(double t) const {
  HandThen made{X_WH_rest_, {}};
  made.closure.fill(relaxed);
  for (const Move& move : moves_)
    if (t >= move.begin)
      made.X_WH = along(move.way, minimum_jerk((t - move.begin) / (move.end - move.begin)));
  for (const Squeeze& squeeze : squeezes_) {
    if (t < squeeze.begin) continue;
    const double share = minimum_jerk((t - squeeze.begin) / (squeeze.end - squeeze.begin));
    for (std::size_t f = 0; f < made.closure.size(); ++f)
      made.closure[f] = (1 - share) * squeeze.from[f] + share * squeeze.to[f];
  }
  return made;
}

std::vector<Person::ObjectThen> Person::objects(double t) const {
  std::vector<ObjectThen> made;
  for (const Thing& thing : things_) made.push_back({thing.name, thing.shape, thing.X_WO, false});
  for (const Carry& carry : carries_) {
    if (t < carry.begin) continue;
    made[carry.object].X_WO = hand(std::min(t, carry.end)).X_WH * carry.X_HO;
    made[carry.object].hidden = t < carry.end;
  }
  return made;
}

}  // namespace prehend::demonstration
