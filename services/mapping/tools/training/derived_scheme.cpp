#include "services/mapping/tools/training/derived_scheme.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <set>

#include "common/model/finger_chain.hpp"

namespace prehend::mapping {

namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::array names{"thumb", "index", "little"};  // of the drivers
constexpr double most = 0.85;  // of its range that a turning joint closes: past it fingers cross
constexpr double half_closed = 0.5;  // share from which a posture is no beginning

std::size_t number(Driver driver) {
  return static_cast<std::size_t>(driver);
}

/// What each DoF can still close from the open hand, rad or m, with its sign; 0: does not close.
VectorXd closing_ways(const model::HandModel& hand) {
  VectorXd way = hand.postures().at("open");
  for (Eigen::Index i = 0; i < way.size(); ++i) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
    const double end = dof.closing > 0 ? dof.upper : dof.closing < 0 ? dof.lower : way[i];
    way[i] = end - way[i];
  }
  return way;
}

/// A fingertip and what moves it, in B.
struct Tip {
  std::set<int> dofs;
  Vector3d open, closing;  // m: of the open hand, and when it has closed by a part
  Vector3d root;           // where the finger begins
};

std::vector<Tip> tips_of(const model::HandModel& hand) {
  constexpr double part = 0.3;
  const VectorXd open = hand.postures().at("open");
  const auto X_BL = hand.link_poses(hand.joint_angles(open));
  const auto p_open = hand.fingertip_positions(open);
  const auto p_closing = hand.fingertip_positions(hand.clamp(open + part * closing_ways(hand)));
  std::vector<std::vector<int>> chains;
  for (const model::HandFingertip& tip : hand.fingertips())
    chains.push_back(model::joints_to(hand, tip.link));
  // Joints that move every fingertip belong to a wrist, not to a finger.
  const auto moves_all = [&](int joint) {
    return chains.size() > 1 && std::all_of(chains.begin(), chains.end(), [&](const auto& other) {
             return std::find(other.begin(), other.end(), joint) != other.end();
           });
  };
  std::vector<Tip> tips;
  for (std::size_t f = 0; f < chains.size(); ++f) {
    Tip tip{{}, p_open[f], p_closing[f], p_open[f]};
    for (auto joint = chains[f].rbegin(); joint != chains[f].rend(); ++joint) {
      const model::HandJoint& j = hand.joints()[static_cast<std::size_t>(*joint)];
      tip.dofs.insert(j.dof);
      if (!moves_all(*joint)) tip.root = X_BL[static_cast<std::size_t>(j.child)].translation();
    }
    tips.push_back(std::move(tip));
  }
  return tips;
}

/// The finger that closes most against the others; of equal ones, which fingers around a circle
/// are, the one that stands alone. Of two the first.
std::size_t opposing(const std::vector<Tip>& tips) {
  constexpr double by_place = 5;  // 1/m
  std::size_t thumb = 0;
  if (tips.size() < 3) return thumb;
  double best = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < tips.size(); ++i) {
    Vector3d way = Vector3d::Zero(), middle = Vector3d::Zero();
    for (std::size_t k = 0; k < tips.size(); ++k) {
      if (k == i) continue;
      way += tips[k].closing - tips[k].open;
      middle += tips[k].open / static_cast<double>(tips.size() - 1);
    }
    const Vector3d own = tips[i].closing - tips[i].open;
    const double score =
        own.normalized().dot(way.normalized()) - by_place * (tips[i].open - middle).norm();
    if (score >= best) continue;
    best = score;
    thumb = i;
  }
  return thumb;
}

std::optional<Driver> told(const model::HandFingertip& tip) {
  if (!tip.human) return std::nullopt;
  switch (*tip.human) {
    case model::Finger::thumb:
      return Driver::thumb;
    case model::Finger::index:
    case model::Finger::middle:
      return Driver::index;
    default:
      return Driver::little;
  }
}

bool has(const std::vector<std::optional<Driver>>& driver, Driver wanted) {
  return std::find(driver.begin(), driver.end(), wanted) != driver.end();
}

/// Of the fingers for which nothing is told, those two stand at the ends of their row that are
/// farthest from each other: the one of them that begins nearer to where the thumb does.
std::optional<std::size_t> first_of_row(const std::vector<Tip>& tips,
                                        const std::vector<std::optional<Driver>>& driver) {
  std::optional<std::size_t> first;
  std::vector<std::size_t> row;
  Vector3d thumb = Vector3d::Zero();
  for (std::size_t i = 0; i < tips.size(); ++i) {
    if (!driver[i]) row.push_back(i);
    if (driver[i] == Driver::thumb) thumb = tips[i].root;
  }
  double widest = -1;
  for (const std::size_t a : row)
    for (const std::size_t b : row) {
      const double apart = (tips[a].open - tips[b].open).norm();
      if (apart <= widest) continue;
      widest = apart;
      first = (tips[a].root - thumb).norm() <= (tips[b].root - thumb).norm() ? a : b;
    }
  return first;
}

/// How far a posture is closed, of what the hand can close: 0 the open hand, 1 a fist.
double closure_of(const VectorXd& posture, const VectorXd& open, const VectorXd& way) {
  double sum = 0;
  int count = 0;
  for (Eigen::Index i = 0; i < way.size(); ++i)
    if (way[i] != 0) {
      sum += (posture[i] - open[i]) / way[i];
      ++count;
    }
  return count == 0 ? 0 : sum / count;
}

SchemePosture named(const char* name, const VectorXd& robot) {
  SchemePosture posture;
  posture.name = name;
  posture.robot = robot;
  return posture;
}

/// DoFs that close fingers which stay out of a grasp by thumb, index and middle finger, and no
/// others.
std::vector<bool> resting_in_precision(const model::HandModel& hand, const std::vector<Tip>& tips,
                                       const std::vector<Driver>& driver) {
  std::vector<bool> resting(hand.dofs().size(), false);
  std::vector<std::pair<double, std::size_t>> away;  // from the index finger
  Vector3d index = Vector3d::Zero();
  for (std::size_t i = 0; i < tips.size(); ++i)
    if (driver[i] == Driver::index) index = tips[i].open;
  for (std::size_t i = 0; i < tips.size(); ++i)
    if (driver[i] == Driver::little) away.emplace_back((tips[i].open - index).norm(), i);
  std::sort(away.begin(), away.end());
  std::set<int> taking;
  std::vector<std::size_t> out;
  for (std::size_t k = 1; k < away.size(); ++k) out.push_back(away[k].second);
  for (std::size_t i = 0; i < tips.size(); ++i)
    if (std::find(out.begin(), out.end(), i) == out.end())
      taking.insert(tips[i].dofs.begin(), tips[i].dofs.end());
  for (const std::size_t i : out)
    for (const int dof : tips[i].dofs)
      if (!taking.contains(dof) && hand.dofs()[static_cast<std::size_t>(dof)].closing != 0)
        resting[static_cast<std::size_t>(dof)] = true;
  return resting;
}

}  // namespace

std::vector<Driver> drivers(const model::HandModel& hand) {
  const auto tips = tips_of(hand);
  std::vector<std::optional<Driver>> driver;
  for (const model::HandFingertip& tip : hand.fingertips()) driver.push_back(told(tip));
  if (!has(driver, Driver::thumb) && tips.size() > 1)
    if (auto& thumb = driver[opposing(tips)]; !thumb) thumb = Driver::thumb;
  if (!has(driver, Driver::index))
    if (const auto first = first_of_row(tips, driver)) driver[*first] = Driver::index;
  std::vector<Driver> found;
  for (const auto& one : driver) found.push_back(one.value_or(Driver::little));
  return found;
}

Scheme derive_scheme(const model::HandModel& hand) {
  const auto tips = tips_of(hand);
  const auto driver = drivers(hand);
  const VectorXd open = hand.postures().at("open"), way = closing_ways(hand);
  Scheme scheme;
  scheme.name = hand.name() + ", derived";
  scheme.open = named("open", open);
  for (const char* name : names) scheme.closed.push_back(named(name, open));
  scheme.closed[number(Driver::thumb)].human = {1, 0, 0, 0, 0};
  scheme.closed[number(Driver::index)].human = {0, 1, 1, 0, 0};
  scheme.closed[number(Driver::little)].human = {0, 0, 0, 1, 1};
  for (Eigen::Index i = 0; i < way.size(); ++i) {
    std::set<Driver> parts;
    for (std::size_t f = 0; f < tips.size(); ++f)
      if (tips[f].dofs.contains(static_cast<int>(i))) parts.insert(driver[f]);
    if (parts.empty()) parts = {driver.begin(), driver.end()};
    const bool turns = hand.dofs()[static_cast<std::size_t>(i)].kind == model::JointKind::revolute;
    const double share = (turns ? most : 1.0) / static_cast<double>(parts.size());
    for (const Driver part : parts) scheme.closed[number(part)].robot[i] += share * way[i];
  }

  const auto resting = resting_in_precision(hand, tips, driver);
  const std::vector<bool> all_close(resting.size(), false);
  std::vector<VectorXd> beginnings{open};
  for (const auto& [name, posture] : hand.postures())
    if (name != "open" && closure_of(posture, open, way) < half_closed)
      beginnings.push_back(posture);
  scheme.lower = scheme.upper = open;
  for (const VectorXd& robot : beginnings) {
    const std::vector<GraspType> all(grasp_types.begin(), grasp_types.end());
    scheme.preshapes.push_back({robot, all, all_close});
    if (resting != all_close) scheme.preshapes.push_back({robot, {GraspType::precision}, resting});
    scheme.lower = scheme.lower.cwiseMin(robot);
    scheme.upper = scheme.upper.cwiseMax(robot);
  }
  for (Eigen::Index i = 0; i < way.size(); ++i) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
    if (dof.closing == 0) continue;
    scheme.lower[i] = dof.lower;
    scheme.upper[i] = dof.upper;
  }
  return scheme;
}

Expected<Scheme> load_or_derive(const std::filesystem::path& file, const model::HandModel& hand) {
  std::error_code none;
  return std::filesystem::exists(file, none) ? Scheme::load(file, hand) : derive_scheme(hand);
}

}  // namespace prehend::mapping
