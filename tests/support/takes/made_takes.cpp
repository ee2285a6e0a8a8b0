#include "tests/support/takes/made_takes.hpp"

#include <fmt/format.h>

#include "common/base/random.hpp"

namespace prehend::test {

using demonstration::HandSample;
using demonstration::Take;

namespace {

Take made_take(const MadeTakes& wanted, std::size_t kind, double scale, Random& random) {
  Take take{.label = wanted.classes[kind], .samples = {}};
  const double opening = 0.04 + 0.02 * static_cast<double>(kind);
  const double tilt = 0.5 * static_cast<double>(kind), speed = 0.05 * static_cast<double>(kind + 1);
  for (int i = 0; i < wanted.samples; ++i) {
    const double closing = 1.3 - 0.3 * i / wanted.samples;
    HandSample sample{.t = 0.01 * i};
    for (std::size_t f = 0; f < sample.p_thumb_tip_W.size(); ++f) {
      const double spread = 0.2 * static_cast<double>(f);
      sample.p_thumb_tip_W[f] =
          scale * closing * opening *
              Eigen::Vector3d(std::cos(tilt + spread), std::sin(spread), std::sin(tilt + spread)) +
          random.normal3(wanted.noise);
    }
    sample.hand_speed = speed * random.uniform(0.8, 1.2);
    sample.wrist_speed = speed * random.uniform(0.8, 1.2);
    take.samples.push_back(sample);
  }
  return take;
}

}  // namespace

std::vector<Take> made_takes(const MadeTakes& wanted) {
  Random random(wanted.seed);
  std::vector<Take> takes;
  for (int person = 0; person < wanted.people; ++person) {
    const double scale = random.uniform(0.9, 1.1);
    for (std::size_t kind = 0; kind < wanted.classes.size(); ++kind)
      for (int trial = 0; trial < wanted.trials; ++trial) {
        takes.push_back(made_take(wanted, kind, scale, random));
        takes.back().user = fmt::format("{}", person);
        takes.back().task = "1";
        takes.back().side = "left";
        takes.back().action = "lift";
        takes.back().trial = trial;
      }
  }
  return takes;
}

std::string to_csv(const std::vector<Take>& takes) {
  std::string text = "user,task,object,side,action,trial,t_ms,hand_speed_m_s,wrist_speed_m_s";
  for (const char* finger : {"index", "middle", "ring", "little"})
    for (const char axis : {'x', 'y', 'z'}) text += fmt::format(",thumb_{}_{}_cm", finger, axis);
  text += "\n";
  for (const Take& take : takes)
    for (const HandSample& sample : take.samples) {
      text += fmt::format("{},{},{},{},{},{},{:.1f},{:.4f},{:.4f}", take.user, take.task,
                          take.label, take.side, take.action, take.trial, 1000 * sample.t,
                          sample.hand_speed, sample.wrist_speed);
      for (const Eigen::Vector3d& tip : sample.p_thumb_tip_W)  // x up, y forward, z left
        text += fmt::format(",{:.3f},{:.3f},{:.3f}", 100 * tip.z(), 100 * tip.x(), 100 * tip.y());
      text += "\n";
    }
  return text;
}

}  // namespace prehend::test
