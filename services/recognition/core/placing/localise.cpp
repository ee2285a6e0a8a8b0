#include "services/recognition/core/placing/localise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/recognition/core/placing/area.hpp"
#include "services/recognition/core/placing/certainty.hpp"
#include "services/recognition/core/placing/colour_bins.hpp"
#include "services/recognition/core/placing/contrast.hpp"
#include "services/recognition/core/placing/evidence.hpp"
#include "services/recognition/core/placing/hidden.hpp"

namespace prehend::recognition {
namespace {

constexpr double pi = std::numbers::pi;
/// An outline that agrees less with the first evidence is not looked at any further.
constexpr double min_promise = 0.25;

struct Candidate {
  TablePose at;
  double score = -1e18;
};

/// The turn after which a shape looks the same: a cylinder's any, a box' half, a cube's quarter.
double yaw_period(const model::Shape& shape) {
  if (shape.kind != model::ShapeKind::box) return 0;
  return std::abs(shape.size.x() - shape.size.y()) < 1e-3 ? pi / 2 : pi;
}

class Fitter {
 public:
  Fitter(const FittingImage& frame, const CameraModel& camera, const model::Shape& shape,
         const Eigen::VectorXf& known_colours)
      : frame_(frame), camera_(camera), shape_(shape), known_(known_colours) {}

  std::optional<Fit> run(double x, double y, double reach) {
    if (!choose_area(x, y, reach)) return std::nullopt;
    const Evidence evidence = learned_evidence();
    const std::vector<Candidate> hypotheses = promising(evidence, x, y, reach);
    if (hypotheses.empty()) return std::nullopt;
    Settled winner = best_of(hypotheses);
    // Something before it? Then what is seen of it counts.
    double hidden = 0;
    if (look_for_hidden(winner.at)) {
      winner = best_of({Candidate{winner.at}});
      hidden = hidden_share(winner.at);
    }
    return describe(winner, hidden);
  }

 private:
  std::size_t local(int px, int py) const { return area_.index(px, py); }

  /// A hypothesis that stands still, with the estimate of what is object that it came to.
  struct Settled {
    TablePose at;
    double agreement = 0;  // of its outline: overlap by either estimate, and contrast
    Evidence evidence;
  };

  /// By the colours that were learned, before anything is estimated from the picture.
  Evidence learned_evidence() {
    Evidence evidence(area_.left, area_.top, area_.width(), area_.height());
    initial_.resize(static_cast<std::size_t>(area_.width() * area_.height()));
    hidden_.assign(initial_.size(), 0);
    const Eigen::VectorXf unlike = log_unlike_surroundings();
    const Eigen::VectorXf like = log_like_object();
    evidence.fill([&](int px, int py) {
      const std::size_t i = frame_.colours.index(px, py);
      const float value =
          frame_.taken.values[i] ? 0.f : unlike[frame_.bins[i]] + like[frame_.colours.values[i]];
      initial_[local(px, py)] = value;
      return static_cast<double>(value);
    });
    return evidence;
  }

  /// The hypotheses that are worth settling; none where no outline agrees with the first evidence.
  std::vector<Candidate> promising(const Evidence& evidence, double x, double y,
                                   double reach) const {
    std::vector<Candidate> best = search(evidence, x, y, reach);
    double promise = 0;
    for (Candidate& candidate : best) {
      refine(evidence, candidate, 0.006, 0.13);
      promise = std::max(promise, first_agreement(candidate.at));
    }
    if (promise < min_promise) return {};
    drop_repeated(best);
    return best;
  }

  /// Scores of different estimates do not compare: the hypotheses compete by how well each outline
  /// agrees with its own estimate of what is object and what is around. Of one hypothesis at least.
  Settled best_of(std::vector<Candidate> hypotheses) const {
    std::optional<Settled> best;
    for (Candidate& candidate : hypotheses) {
      Evidence own = settle(candidate);
      const double agreed =
          agreement(candidate.at, [&](int px, int py) { return own.at(px, py) > 0; }) +
          first_agreement(candidate.at) + contrast(candidate.at);
      if (!best || agreed > best->agreement) best = Settled{candidate.at, agreed, std::move(own)};
    }
    return *std::move(best);
  }

  std::optional<Fit> describe(const Settled& settled, double hidden) const {
    const auto region = silhouette(camera_, shape_, settled.at);
    if (!region) return std::nullopt;
    Fit fit;
    fit.at = settled.at;
    fit.at.yaw = wrap(fit.at.yaw);
    fit.region = *region;
    fit.visible = Plane(frame_.taken.width, frame_.taken.height);
    area_.visit(*region, [&](int px, int py) { fit.visible.at(px, py) = seen(px, py); });
    fit.hidden = hidden;
    fit.measured = measured_size(settled.evidence, camera_, shape_, settled.at);
    fit.contrast = contrast(settled.at);
    fit.agreement = (settled.agreement - fit.contrast) / 2;
    fit.covariance = covariance(settled.evidence, camera_, shape_, settled.at);
    // An outline that agrees badly may lie elsewhere altogether: a centimetre at an agreement of
    // 0.4.
    const double elsewhere = 0.025 * std::max(0.0, 0.8 - fit.agreement);
    fit.covariance.diagonal().head<2>().array() += elsewhere * elsewhere;
    // What is hidden says nothing of where its outline is: 1 mm and 1 degree at a third.
    const Eigen::Vector3d unseen = fit.hidden * Eigen::Vector3d(0.003, 0.003, 0.05);
    fit.covariance.diagonal() += unseen.cwiseAbs2();
    return fit;
  }

  /// Moves a hypothesis until it stands still, re-estimating what is object and what is not; two
  /// rounds are enough where object and table part well. Returns the last estimate.
  Evidence settle(Candidate& candidate) const {
    Evidence own = nearby(candidate.at);
    for (int round = 0; round < 8; ++round) {
      const TablePose before = candidate.at;
      reestimate(own, candidate.at);
      shift(own, candidate);
      refine(own, candidate, round == 0 ? 0.008 : 0.004, 0.10);
      const double moved = std::hypot(candidate.at.x - before.x, candidate.at.y - before.y);
      if (round > 0 && moved < 0.001) break;
      if (moved > 0.01) own = nearby(candidate.at);
    }
    reestimate(own, candidate.at);
    return own;
  }

  /// Shows neither another known object nor what stands before this one.
  bool seen(int px, int py) const {
    return !frame_.taken.values[frame_.colours.index(px, py)] && !hidden_[local(px, py)];
  }

  /// True when something before the object was found.
  bool look_for_hidden(const TablePose& at) {
    const auto inside = silhouette(camera_, shape_, at);
    const auto around = silhouette(camera_, shape_, at, 0.05);
    if (inside && around) hidden_ = find_hidden(frame_, area_, *inside, *around, known_);
    return std::find(hidden_.begin(), hidden_.end(), 1) != hidden_.end();
  }

  double contrast(const TablePose& at) const {
    const auto polygon = outline(camera_, shape_, at);
    if (!polygon) return 0;
    return outline_contrast(frame_.picture, *polygon,
                            [&](int px, int py) { return !area_.holds(px, py) || seen(px, py); });
  }

  double hidden_share(const TablePose& at) const {
    const auto region = silhouette(camera_, shape_, at);
    if (!region) return 0;
    int hidden = 0;
    area_.visit(*region, [&](int px, int py) { hidden += hidden_[local(px, py)]; });
    return static_cast<double>(hidden) / std::max(1, region->area());
  }

  double wrap(double yaw) const {
    const double period = yaw_period(shape_);
    return period > 0 ? std::remainder(yaw, period) : 0;
  }

  /// Room for evidence around a hypothesis that only moves a little any more.
  Evidence nearby(const TablePose& at) const {
    const auto around = silhouette(camera_, shape_, at, 0.06);
    if (!around) return Evidence(area_.left, area_.top, area_.width(), area_.height());
    int low = area_.right, high = area_.left;
    for (const Silhouette::Span& span : around->rows) {
      if (span.right <= span.left) continue;
      low = std::min(low, span.left);
      high = std::max(high, span.right);
    }
    // Below, the outline does not grow with the margin: some rows for moving nearer.
    const int first = std::clamp(around->top, area_.top, area_.bottom);
    const int last =
        std::clamp(around->top + static_cast<int>(around->rows.size()) + 30, first, area_.bottom);
    low = std::clamp(low, area_.left, area_.right);
    high = std::clamp(high, low, area_.right);
    return Evidence(low, first, high - low, last - first);
  }

  bool choose_area(double x, double y, double reach) {
    const double around = reach + 0.06;
    double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
    const Eigen::Vector3d half = model::half_extents(shape_);
    const double r = std::hypot(half.x(), half.y()) + around;
    for (const double u : {-r, r})
      for (const double v : {-r, r})
        for (const double z : {0.0, 2 * half.z() + 0.02}) {
          const auto pixel = camera_.project({x + u, y + v, z});
          if (!pixel) return false;
          low_x = std::min(low_x, pixel->x());
          high_x = std::max(high_x, pixel->x());
          low_y = std::min(low_y, pixel->y());
          high_y = std::max(high_y, pixel->y());
        }
    const auto limit = [](double v, int size) {
      return static_cast<int>(std::clamp(v, 0.0, double(size)));
    };
    area_.left = limit(low_x, camera_.width);
    area_.right = limit(high_x + 1, camera_.width);
    area_.top = limit(low_y, camera_.height);
    area_.bottom = limit(high_y + 1, camera_.height);
    return area_.width() > 4 && area_.height() > 4;
  }

  /// What is rare in the picture is likely no table. Mild: shadows are rare, too.
  Eigen::VectorXf log_unlike_surroundings() const {
    return (0.5f * ((1.0f / 2000) / (frame_.bin_share.array() + 1e-5f)).log())
        .cwiseMax(-1.5f)
        .cwiseMin(1.0f);
  }
  Eigen::VectorXf log_like_object() const {
    return ((known_.array() + 0.004f) / (frame_.colour_share.array() + 0.004f))
        .log()
        .cwiseMax(-2.f)
        .cwiseMin(2.f);
  }

  double score(const Evidence& evidence, const TablePose& at) const {
    const auto region = silhouette(camera_, shape_, at);
    return region ? evidence.sum(*region) : -1e18;
  }

  /// A coarse grid over place and turn; the best three that are well parted in either.
  std::vector<Candidate> search(const Evidence& evidence, double x, double y, double reach) const {
    const double period = yaw_period(shape_);
    const int turns = period > 0 ? static_cast<int>(std::lround(period / (pi / 10))) : 1;
    const double step = std::clamp(reach / 4, 0.008, 0.02);
    std::vector<Candidate> tried;
    for (int k = 0; k < turns; ++k)
      for (double dx = -reach; dx <= reach + 1e-9; dx += step)
        for (double dy = -reach; dy <= reach + 1e-9; dy += step) {
          const TablePose at{x + dx, y + dy, turns > 1 ? period * k / turns : 0};
          const double value = score(evidence, at);
          if (value > -1e17) tried.push_back({at, value});
        }
    std::sort(tried.begin(), tried.end(),
              [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    std::vector<Candidate> kept;
    for (const Candidate& candidate : tried) {
      const bool close = std::any_of(kept.begin(), kept.end(), [&](const Candidate& other) {
        return std::abs(wrap(candidate.at.yaw - other.at.yaw)) < 0.4 &&
               std::hypot(candidate.at.x - other.at.x, candidate.at.y - other.at.y) < 0.03;
      });
      if (!close) kept.push_back(candidate);
      if (kept.size() == 3) break;
    }
    return kept;
  }

  /// Hypotheses that have met in one place are one.
  void drop_repeated(std::vector<Candidate>& candidates) const {
    std::vector<Candidate> kept;
    for (const Candidate& candidate : candidates) {
      const bool met = std::any_of(kept.begin(), kept.end(), [&](const Candidate& other) {
        return std::abs(wrap(candidate.at.yaw - other.at.yaw)) < 0.1 &&
               std::hypot(candidate.at.x - other.at.x, candidate.at.y - other.at.y) < 0.005;
      });
      if (!met) kept.push_back(candidate);
    }
    candidates = std::move(kept);
  }

  /// Looks 4 cm around for a better place: the learned colours alone may have been misled by a
  /// table that resembles the object.
  void shift(const Evidence& evidence, Candidate& candidate) const {
    const TablePose start = candidate.at;
    candidate.score = score(evidence, start);
    for (int i = -2; i <= 2; ++i)
      for (int j = -2; j <= 2; ++j) {
        const TablePose at{start.x + 0.02 * i, start.y + 0.02 * j, start.yaw};
        const double value = score(evidence, at);
        if (value > candidate.score) candidate = {at, value};
      }
  }

  /// Pattern search with shrinking steps.
  void refine(const Evidence& evidence, Candidate& candidate, double step, double turn) const {
    const bool turns = yaw_period(shape_) > 0;
    candidate.score = score(evidence, candidate.at);
    for (; step > 0.0004; step /= 2, turn /= 2)
      for (int moves = 0; moves < 12; ++moves) {
        Candidate best = candidate;
        const auto attempt = [&](double dx, double dy, double dyaw) {
          const TablePose at{candidate.at.x + dx, candidate.at.y + dy, candidate.at.yaw + dyaw};
          const double value = score(evidence, at);
          if (value > best.score) best = {at, value};
        };
        for (const double s : {-step, step}) {
          attempt(s, 0, 0);
          attempt(0, s, 0);
          attempt(s, s, 0);
          attempt(s, -s, 0);
        }
        if (turns)
          for (const double t : {-turn, turn}) attempt(0, 0, t);
        if (best.score <= candidate.score) break;
        candidate = best;
      }
  }

  /// Colours inside against colours around at a hypothesis, from this picture.
  void reestimate(Evidence& evidence, const TablePose& at) const {
    const auto inside = silhouette(camera_, shape_, at);
    const auto near = silhouette(camera_, shape_, at, 0.004);
    const auto around = silhouette(camera_, shape_, at, 0.05);
    if (!inside || !near || !around) return;
    Eigen::VectorXf object = Eigen::VectorXf::Zero(bin_count), ring = object;
    area_.visit(*inside, [&](int px, int py) { object[bin(px, py)] += free(px, py); });
    area_.visit(*around, [&](int px, int py) { ring[bin(px, py)] += free(px, py); });
    area_.visit(*near, [&](int px, int py) { ring[bin(px, py)] -= free(px, py); });
    ring = ring.cwiseMax(0);
    add_shadows(ring);
    smooth(object);
    smooth(ring);
    const Eigen::VectorXf background = 0.8f * ring + 0.2f * frame_.bin_share;
    const Eigen::VectorXf ratio = ((object.array() + 2e-4f) / (background.array() + 2e-4f))
                                      .log()
                                      .cwiseMax(-2.5f)
                                      .cwiseMin(2.5f);
    evidence.fill([&](int px, int py) {
      if (!seen(px, py)) return 0.0;
      return static_cast<double>(ratio[bin(px, py)] + 0.3f * initial_[local(px, py)]);
    });
  }

  Eigen::Index bin(int px, int py) const { return frame_.bins[frame_.colours.index(px, py)]; }
  float free(int px, int py) const { return seen(px, py) ? 1.f : 0.f; }

  /// Intersection over union of the outline with the pixels nearby that `yes` takes for the object.
  template <class Yes>
  double agreement(const TablePose& at, Yes yes) const {
    const auto region = silhouette(camera_, shape_, at);
    const auto around = silhouette(camera_, shape_, at, 0.03);
    if (!region || !around) return 0;
    const auto count = [&](const Silhouette& r, bool all) {
      int sum = 0;
      area_.visit(r, [&](int px, int py) { sum += seen(px, py) && (all || yes(px, py)); });
      return sum;
    };
    const int inside = count(*region, false);
    const int united = count(*region, true) + std::max(0, count(*around, false) - inside);
    return united > 0 ? static_cast<double>(inside) / united : 0;
  }
  double first_agreement(const TablePose& at) const {
    return agreement(at, [&](int px, int py) { return initial_[local(px, py)] > 0; });
  }

  const FittingImage& frame_;
  const CameraModel& camera_;
  const model::Shape& shape_;
  const Eigen::VectorXf& known_;
  Area area_;                         // that is looked at
  std::vector<float> initial_;        // evidence before re-estimation
  std::vector<std::uint8_t> hidden_;  // 1: something stands before the object
};

}  // namespace

std::optional<Fit> localise(const FittingImage& frame, const CameraModel& camera,
                            const model::Shape& shape, const Eigen::VectorXf& known_colours,
                            double x, double y, double reach) {
  if (!model::is_valid(shape) || known_colours.size() != frame.colour_share.size())
    return std::nullopt;
  if (camera.width != frame.picture.width || camera.height != frame.picture.height)
    return std::nullopt;
  return Fitter(frame, camera, shape, known_colours).run(x, y, reach);
}

}  // namespace prehend::recognition
