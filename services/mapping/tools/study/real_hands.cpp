// Not in [Thesis]: direct and intelligent mapping on the fingers of real thesis_hands. Nobody
// knows what a robot should have answered, so only what can be said without that is said.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "common/grasping/table_closing.hpp"
#include "common/model/placement.hpp"
#include "services/mapping/tools/study/experiment.hpp"
#include "services/mapping/tools/training/demonstrator.hpp"

namespace prehend::mapping {

namespace {

constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();
constexpr std::array answerers{"direct", "intelligent"};
/// extrapolating: share of frames; thumb: of those, where the thumb's place is outside. too fast:
/// share of the steps between frames in which some joint would have to exceed its velocity.
/// follows: rank correlation of a finger's bending with the robot fingers it drives, mean of thumb,
/// index and little finger. grab, pinch: that of what the camera's software says with the robot's
/// closing. splay: how far the robot closes while fingers spread.
constexpr std::array measures{"extrapolating", "thumb", "too fast", "follows",
                              "grab",          "pinch", "splay"};

std::string column(std::string_view hand, std::string_view answerer, std::string_view measure) {
  return fmt::format("{} {} {}", hand, answerer, measure);
}

/// Ranks from 1, equal numbers sharing theirs.
std::vector<double> ranks(const std::vector<double>& numbers) {
  std::vector<std::size_t> order(numbers.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return numbers[a] < numbers[b]; });
  std::vector<double> rank(numbers.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i;
    while (end < order.size() && numbers[order[end]] == numbers[order[i]]) ++end;
    for (std::size_t k = i; k < end; ++k) rank[order[k]] = 0.5 * static_cast<double>(i + end + 1);
    i = end;
  }
  return rank;
}

/// Spearman's rank correlation; not-a-number where one of them never varies.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto x = ranks(a), y = ranks(b);
  const double mean = 0.5 * static_cast<double>(a.size() + 1);
  double xx = 0, yy = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean) * (x[i] - mean);
    yy += (y[i] - mean) * (y[i] - mean);
    xy += (x[i] - mean) * (y[i] - mean);
  }
  return xx > 0 && yy > 0 ? xy / std::sqrt(xx * yy) : not_measured;
}

double mean(const std::vector<double>& numbers) {
  double sum = 0;
  int count = 0;
  for (const double number : numbers)
    if (std::isfinite(number)) sum += number, ++count;
  return count > 0 ? sum / count : not_measured;
}

/// The sensors of a glove on these fingers, which sit askew as those of synthetic people do.
class Sensors {
 public:
  explicit Sensors(std::uint64_t seed) {
    Random random(seed);
    const auto direction = [&] { return random.normal3(1).normalized(); };
    const DemonstratorOptions people;
    const Eigen::AngleAxisd turn(random.uniform(0, people.mounting_turn), direction());
    X_HR_ = make_pose(direction() * random.uniform(0, people.mounting), turn.toRotationMatrix());
    for (Eigen::Vector3d& off : off_H_) off = direction() * random.uniform(0, people.mounting);
  }
  Fingertips read(Fingertips fingertips) const {
    for (std::size_t f = 0; f < fingertips.size(); ++f)
      fingertips[f].p_HF = X_HR_.inverse() * (fingertips[f].p_HF + off_H_[f]);
    return fingertips;
  }

 private:
  Pose X_HR_;
  std::array<Eigen::Vector3d, model::finger_count> off_H_;
};

/// How far the robot fingers are closed that a human finger drives, 0 to 1 as the scheme closes
/// them.
double closed_by(const Scheme& scheme, const char* finger, const Eigen::VectorXd& dof) {
  const auto closed = std::find_if(scheme.closed.begin(), scheme.closed.end(),
                                   [&](const SchemePosture& p) { return p.name == finger; });
  const Eigen::VectorXd way = closed->robot - scheme.open.robot;
  return way.dot(dof - scheme.open.robot) / way.squaredNorm();
}

/// What one answerer makes of one take.
struct Followed {
  std::vector<double> grab, pinch;                  // what the camera's software says
  std::array<std::vector<double>, 3> bent, closed;  // thumb, index, little
  std::vector<double> whole;                        // mean of thumb and index
  double frames = 0, extrapolating = 0, thumb = 0, steps = 0, too_fast = 0;
};

/// With the tolerance that the model has for noise.
bool thumb_is_outside(const MappingModel& model, const Features& seen) {
  const learning::Scaling& trained = model.networks().front().input;
  const Eigen::ArrayXd low = trained.minimum().head<3>(), high = trained.maximum().head<3>();
  const Eigen::ArrayXd noise = 0.05 * (high - low), thumb = seen.head<3>();
  return (thumb < low - noise).any() || (thumb > high + noise).any();
}

Followed follow(const StudiedHand& hand, const RealTake& take, const Sensors& sensors,
                bool intelligent) {
  // Pringles, from the side: every hand has learnt to grasp it so.
  const model::Shape pringles{model::ShapeKind::cylinder, {0.037, 0.037, 0.230}};
  const Pose X_OG = grasping::approaches(pringles, hand.hand.reach()).back();
  Followed made;
  std::optional<Eigen::VectorXd> before;
  double time = 0;
  for (const RealTake::Frame& frame : take.frames) {
    const auto seen = features(sensors.read(frame.fingertips), take.hand_scale);
    if (!seen) continue;
    const NetworkAnswer answer =
        intelligent
            ? hand.model->intelligent(*seen, pringles, X_OG).value_or(hand.model->direct(*seen))
            : hand.model->direct(*seen);
    ++made.frames;
    made.extrapolating += answer.extrapolating;
    made.thumb += answer.extrapolating && thumb_is_outside(*hand.model, *seen);
    if (before) {
      ++made.steps;
      bool fast = false;
      for (Eigen::Index i = 0; i < answer.dof.size(); ++i)
        fast = fast ||
               std::abs(answer.dof[i] - (*before)[i]) >
                   hand.hand.dofs()[static_cast<std::size_t>(i)].max_velocity * (frame.time - time);
      made.too_fast += fast;
    }
    before = answer.dof;
    time = frame.time;
    made.grab.push_back(frame.grab);
    made.pinch.push_back(frame.pinch);
    const Eigen::Vector3d bent = bending(*seen);
    constexpr std::array drivers{"thumb", "index", "little"};
    for (std::size_t f = 0; f < drivers.size(); ++f) {
      made.bent[f].push_back(bent[static_cast<Eigen::Index>(f)]);
      made.closed[f].push_back(closed_by(hand.scheme, drivers[f], answer.dof));
    }
    made.whole.push_back(0.5 * (made.closed[0].back() + made.closed[1].back()));
  }
  return made;
}

Eigen::VectorXd real_hand_row(const Parts& parts, const Repetition& repetition) {
  const Sensors sensors(repetition.seed);
  std::vector<double> numbers;
  for (const char* hand : thesis_hands)
    for (std::size_t a = 0; a < answerers.size(); ++a) {
      double frames = 0, extrapolating = 0, thumb = 0, steps = 0, too_fast = 0;
      std::vector<double> follows;
      double grab = not_measured, pinch = not_measured, splay = not_measured;
      for (const RealTake& take : parts.real_takes) {
        const Followed made = follow(parts.hand(hand), take, sensors, a == 1);
        frames += made.frames;
        extrapolating += made.extrapolating;
        thumb += made.thumb;
        steps += made.steps;
        too_fast += made.too_fast;
        if (take.name == "grab") {
          grab = rank_correlation(made.grab, made.whole);
          for (std::size_t f = 0; f < made.bent.size(); ++f)
            follows.push_back(rank_correlation(made.bent[f], made.closed[f]));
        } else if (take.name == "pinch") {
          pinch = rank_correlation(made.pinch, made.whole);
        } else if (take.name.starts_with("HandSplay")) {
          splay = mean(made.whole);
        }
      }
      for (const double value :
           {frames > 0 ? extrapolating / frames : not_measured,
            extrapolating > 0 ? thumb / extrapolating : not_measured,
            steps > 0 ? too_fast / steps : not_measured, mean(follows), grab, pinch, splay})
        numbers.push_back(value);
    }
  return Eigen::VectorXd::Map(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

/// A claim about one measure in all hands: above (or below) a limit.
struct Claim {
  std::string_view measure;
  const char* claim;
  const char* measured;  // what the numbers are
  double limit = 0;
  bool above = true;
};

Finding judge_claim(const Table& table, const Claim& claim) {
  Finding finding{"real", claim.claim, claim.measured, Reproduction::undecided, ""};
  std::vector<Reproduction> verdicts;
  for (const char* hand : thesis_hands)
    for (const char* answerer : answerers) {
      const statistics::Interval value =
          statistics::mean_interval(table[column(hand, answerer, claim.measure)]);
      finding.measured += fmt::format(
          "{} {} {}: {}", hand == thesis_hands.front() && answerer == answerers.front() ? ":" : ",",
          hand, answerer, to_text(value));
      statistics::Interval margin{value.mean - claim.limit, value.low - claim.limit,
                                  value.high - claim.limit, value.count};
      if (!claim.above) margin = {-margin.mean, -margin.high, -margin.low, margin.count};
      verdicts.push_back(above_zero(margin));
    }
  finding.verdict = all_of(verdicts);
  finding.reason =
      fmt::format("each is judged against {}; over redrawn mountings of the sensors", claim.limit);
  return finding;
}

Outcome judge_real_hand(const Table& table) {
  Outcome outcome;
  for (const Claim& claim :
       {Claim{"extrapolating", "Real fingers lie within what synthetic people have shown",
              "share of frames outside", 0.1, false},
        Claim{"too fast", "Answers to real fingers are no faster than the joints may go",
              "share of steps that are", 0.05, false},
        Claim{"follows", "Robot fingers close in the order in which real ones bend",
              "rank correlation while grabbing, mean of three fingers", 0.8, true},
        Claim{"grab", "Who grabs closes the robot hand",
              "rank correlation of the camera's grab with the closing", 0.8, true},
        Claim{"pinch", "Who pinches closes thumb and index finger of the robot hand",
              "rank correlation of the camera's pinch with the closing", 0.8, true},
        Claim{"splay", "Who spreads the fingers leaves the robot hand open", "mean closing, 0 to 1",
              0.25, false}})
    outcome.findings.push_back(judge_claim(table, claim));
  outcome.findings.front().reason +=
      fmt::format("; in {} of those frames the thumb is outside",
                  to_text(statistics::mean_interval(
                      table[column(thesis_hands.front(), answerers.front(), "thumb")])));
  outcome.chart = {"", "share, or rank correlation", {}, false, false, {}};
  for (const char* measure : measures) outcome.chart.names.emplace_back(measure);
  for (const char* hand : thesis_hands)
    for (const char* answerer : answerers) {
      ChartSeries series{fmt::format("{} {}", hand, answerer), {}};
      for (std::size_t m = 0; m < measures.size(); ++m)
        series.points.push_back(
            {static_cast<double>(m),
             statistics::mean_interval(table[column(hand, answerer, measures[m])])});
      outcome.chart.series.push_back(std::move(series));
    }
  return outcome;
}

}  // namespace

Experiment real_hands() {
  Experiment experiment{
      "real",
      "Fingers of real hands",
      "Leap recordings of right hands, at most 30 frames a second, on which sensors sit up to 5 mm "
      "and 10° askew, drawn anew each time; the trained models of the live mapping, intelligent as "
      "at the Pringles from the side. «Grab» and «pinch» are what the camera's own software says",
      {thesis_hands.begin(), thesis_hands.end()},
      {},
      30,
      300,
      real_hand_row,
      judge_real_hand};
  experiment.trained = experiment.recordings = true;
  for (const char* hand : thesis_hands)
    for (const char* answerer : answerers)
      for (const char* measure : measures)
        experiment.columns.push_back(column(hand, answerer, measure));
  return experiment;
}

}  // namespace prehend::mapping
