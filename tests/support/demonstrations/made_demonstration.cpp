#include "tests/support/demonstrations/made_demonstration.hpp"

#include <algorithm>

#include "common/base/motion.hpp"
#include "common/base/random.hpp"
#include "common/model/human_hand.hpp"

namespace prehend::test {

using demonstration::Phase;
using demonstration::SceneSample;
using demonstration::Segment;

namespace {

/// A value that goes from place to place.
template <class Value>
class Track {
 public:
  explicit Track(Value start) : start_(start) {}
  /// Moves begin after each other.
  void go(double begin, double end, Value to) { moves_.push_back({begin, end, to}); }
  Value at(double t) const {
    Value now = start_;
    for (const Move& move : moves_) {
      if (t < move.begin) break;
      const double share = minimum_jerk((t - move.begin) / (move.end - move.begin));
      now = (1 - share) * now + share * move.to;
    }
    return now;
  }

 private:
  struct Move {
    double begin, end;
    Value to;
  };
  Value start_;
  std::vector<Move> moves_;
};

/// How far the thumb's tip is from index and middle, fingers closed so far.
double aperture(const model::HumanHand& person, double closure) {
  const auto tips = person.fingertip_poses(
      model::HumanHand::posture({closure, closure, closure, closure, closure}));
  const Eigen::Vector3d thumb = tips[0].translation();
  return ((tips[1].translation() - thumb).norm() + (tips[2].translation() - thumb).norm()) / 2;
}

class Story {
 public:
  explicit Story(const MadeDemonstration& wanted)
      : wanted_(wanted),
        random_(wanted.seed),
        person_(random_.uniform(0.9, 1.1)),
        home_(0.1, -0.3, 0.1),
        hand_(home_),
        closure_(0.4) {
    for (int i = 0; i < wanted.objects; ++i)
      objects_.emplace_back(Eigen::Vector3d(0.35 + 0.2 * i, random_.uniform(-0.1, 0.25), 0.05));
  }

  Shown tell() {
    begin(Phase::rest, random_.uniform(0.4, 1));
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      take(i);
      if (i + 1 == objects_.size() || wanted_.rests_between)
        begin(Phase::rest, random_.uniform(0.4, 1));
    }
    Shown shown{{}, truth_};
    for (double t = 0; t < now_; t += 1 / wanted_.rate) shown.samples.push_back(seen(t));
    return shown;
  }

 private:
  /// A phase from now on, so long.
  void begin(Phase phase, double duration, std::optional<std::size_t> object = {}) {
    truth_.push_back({phase, now_, now_ + duration, object});
    now_ += duration;
  }

  void take(std::size_t i) {
    const double reach = random_.uniform(0.7, 1.2), opened = reach * random_.uniform(0.6, 0.8);
    const Eigen::Vector3d from = objects_[i].at(0);
    const Eigen::Vector3d to(from.x(), from.y() - random_.uniform(0.2, 0.35), from.z());
    hand_.go(now_, now_ + reach, from);
    closure_.go(now_, now_ + 0.9 * opened, random_.uniform(0, 0.1));
    begin(Phase::approach, opened);
    const double closing = reach - opened + random_.uniform(0.1, 0.25);
    closure_.go(now_, now_ + closing, random_.uniform(0.5, 0.7));
    begin(Phase::close, closing, i);
    const double before = random_.uniform(0.1, 0.3), carry = random_.uniform(0.8, 1.5);
    const double lifted = now_ + before;
    const Eigen::Vector3d via = (from + to) / 2 + Eigen::Vector3d(0, 0, 0.2);
    for (Track<Eigen::Vector3d>* track : {&hand_, &objects_[i]}) {
      track->go(lifted, lifted + carry / 2, via);
      track->go(lifted + carry / 2, lifted + carry, to);
    }
    held_.push_back({i, now_, lifted + carry + 0.1});
    begin(Phase::hold, before + carry + random_.uniform(0.1, 0.3), i);
    const double opening = random_.uniform(0.25, 0.5);
    closure_.go(now_, now_ + opening, random_.uniform(0.05, 0.2));
    begin(Phase::release, opening, i);
    const double away = random_.uniform(0.6, 1);
    hand_.go(now_, now_ + away, home_);
    closure_.go(now_, now_ + away, 0.4);
    begin(Phase::retract, away);
  }

  SceneSample seen(double t) {
    SceneSample made{t,
                     hand_.at(t) + random_.normal3(wanted_.noise),
                     aperture(person_, closure_.at(t)) + random_.normal(wanted_.noise),
                     {}};
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      const bool in_hand = std::any_of(held_.begin(), held_.end(), [&](const Held& held) {
        return held.object == i && t >= held.begin && t < held.end;
      });
      made.p_WO.emplace_back(objects_[i].at(t) + random_.normal3(2 * wanted_.noise));
      if (in_hand && wanted_.lost_in_hand) made.p_WO.back().reset();
    }
    return made;
  }

  struct Held {
    std::size_t object;
    double begin, end;
  };
  MadeDemonstration wanted_;
  Random random_;
  model::HumanHand person_;
  Eigen::Vector3d home_;
  Track<Eigen::Vector3d> hand_;
  Track<double> closure_;
  std::vector<Track<Eigen::Vector3d>> objects_;
  std::vector<Held> held_;
  std::vector<Segment> truth_;
  double now_ = 0;
};

}  // namespace

Shown made_demonstration(const MadeDemonstration& wanted) {
  return Story(wanted).tell();
}

}  // namespace prehend::test
