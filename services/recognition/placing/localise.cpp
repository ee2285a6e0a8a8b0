#include "localise.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "colour_bins.hpp"
#include "contrast.hpp"
#include "evidence.hpp"

namespace prehend::recognition {
namespace {

constexpr double pi = std::numbers::pi;
/// An outline that agrees less with the first evidence is not looked at any further.
constexpr double least_promise = 0.25;

struct Candidate {
  Standing at;
  double score = -1e18;
};

/// The turn after which a shape looks the same: a cylinder's any, a box' half, a cube's quarter.
double yaw_period(const model::Shape& shape) {
  if (shape.kind != model::ShapeKind::box) return 0;
  return std::abs(shape.size.x() - shape.size.y()) < 1e-3 ? pi / 2 : pi;
}

class Fitter {
 public:
  Fitter(const Frame& frame, const CameraModel& camera, const model::Shape& shape,
         const Eigen::VectorXf& known_colours)
      : frame_(frame), camera_(camera), shape_(shape), known_(known_colours) {}

  std::optional<Fit> run(double x, double y, double reach) {
    if (!choose_area(x, y, reach)) return std::nullopt;
    Evidence evidence(left_, top_, right_ - left_, bottom_ - top_);
    initial_.resize(static_cast<std::size_t>((right_ - left_) * (bottom_ - top_)));
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
    std::vector<Candidate> best = search(evidence, x, y, reach);
    if (best.empty()) return std::nullopt;
    double promise = 0;
    for (Candidate& candidate : best) {
      refine(evidence, candidate, 0.006, 0.13);
      promise = std::max(promise, first_agreement(candidate.at));
    }
    if (promise < least_promise) return std::nullopt;
    drop_repeated(best);

    // Scores of different estimates do not compare: the hypotheses compete by how well each outline
    // agrees with its own estimate of what is object and what is around.
    Candidate winner;
    double most = -1;
    Evidence sharp = evidence;
    const auto compete = [&](Candidate& candidate) {
      Evidence own = settle(candidate);
      const double agreed =
          agreement(candidate.at, [&](int px, int py) { return own.at(px, py) > 0; }) +
          first_agreement(candidate.at) + contrast(candidate.at);
      if (agreed <= most) return;
      most = agreed;
      winner = candidate;
      sharp = own;
    };
    for (Candidate& candidate : best) compete(candidate);
    // Something before it? Then what is seen of it counts.
    Fit fit;
    if (find_hidden(winner.at)) {
      most = -1;
      Candidate again = winner;
      compete(again);
      fit.hidden = hidden_share(winner.at);
    }
    const auto region = silhouette(camera_, shape_, winner.at);
    if (!region) return std::nullopt;
    fit.at = winner.at;
    fit.at.yaw = wrap(fit.at.yaw);
    fit.region = *region;
    fit.visible = Plane(frame_.taken.width, frame_.taken.height);
    visit(*region, [&](int px, int py) { fit.visible.at(px, py) = seen(px, py); });
    fit.measured = measure(sharp, winner.at);
    fit.contrast = contrast(winner.at);
    fit.agreement = (most - fit.contrast) / 2;
    fit.covariance = covariance(sharp, winner);
    // An outline that agrees badly may lie elsewhere altogether: two centimetres at an agreement of
    // 0.4.
    const double elsewhere = 0.05 * std::max(0.0, 0.8 - fit.agreement);
    fit.covariance.diagonal().head<2>().array() += elsewhere * elsewhere;
    // What is hidden says nothing of where its outline is: 4 mm and 5 degrees at a third.
    const Eigen::Vector3d unseen = fit.hidden * Eigen::Vector3d(0.012, 0.012, 0.25);
    fit.covariance.diagonal() += unseen.cwiseAbs2();
    return fit;
  }

 private:
  std::size_t local(int px, int py) const {
    return static_cast<std::size_t>((py - top_) * (right_ - left_) + px - left_);
  }

  /// Moves a hypothesis until it stands still, re-estimating what is object and what is not; two
  /// rounds are enough where object and table part well. Returns the last estimate.
  Evidence settle(Candidate& candidate) const {
    Evidence own = nearby(candidate.at);
    for (int round = 0; round < 8; ++round) {
      const Standing before = candidate.at;
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

  template <class Use>
  void visit(const Silhouette& region, Use use) const {
    for (std::size_t i = 0; i < region.rows.size(); ++i) {
      const int py = region.top + static_cast<int>(i);
      if (py < top_ || py >= bottom_) continue;
      const int end = std::min(right_, region.rows[i].right);
      for (int px = std::max(left_, region.rows[i].left); px < end; ++px) use(px, py);
    }
  }
  /// Shows neither another known object nor what stands before this one.
  bool seen(int px, int py) const {
    return !frame_.taken.values[frame_.colours.index(px, py)] && !hidden_[local(px, py)];
  }

  /// Finds what stands before the object: patches inside the outline, in colours that it does not
  /// have, which go on beyond the outline. True when they cover enough to matter and not so much
  /// that it is another object altogether.
  bool find_hidden(const Standing& at) {
    const auto inside = silhouette(camera_, shape_, at);
    const auto around = silhouette(camera_, shape_, at, 0.05);
    if (!inside || !around) return false;
    constexpr int block = 4;  // px
    // A patch is strange where its colours are a fifth as frequent on the object as its own are.
    const float not_its = 0.2f * known_.squaredNorm();
    const int across = (right_ - left_ + block - 1) / block;
    const int down = (bottom_ - top_ + block - 1) / block;
    Eigen::ArrayXXi all = Eigen::ArrayXXi::Zero(down, across);
    Eigen::ArrayXXf frequency = Eigen::ArrayXXf::Zero(down, across);  // of its colours, summed
    visit(*inside, [&](int px, int py) {
      if (!seen(px, py)) return;
      const int row = (py - top_) / block, column = (px - left_) / block;
      ++all(row, column);
      frequency(row, column) += known_[frame_.colours.at(px, py)];
    });
    Eigen::ArrayXXi label = Eigen::ArrayXXi::Zero(down, across);
    const double area = all.sum();
    int labels = 0;
    for (int r = 0; r < down; ++r)
      for (int c = 0; c < across; ++c) {
        const auto foreign = [&](int y, int x) {
          return y >= 0 && x >= 0 && y < down && x < across && !label(y, x) && all(y, x) > 0 &&
                 frequency(y, x) < not_its * static_cast<float>(all(y, x));
        };
        if (!foreign(r, c)) continue;
        std::vector<std::pair<int, int>> patch{{r, c}};
        label(r, c) = ++labels;
        for (std::size_t i = 0; i < patch.size(); ++i)
          for (const auto& [dy, dx] :
               {std::pair(0, 1), std::pair(1, 0), std::pair(0, -1), std::pair(-1, 0)}) {
            const auto [y, x] = patch[i];
            if (!foreign(y + dy, x + dx)) continue;
            label(y + dy, x + dx) = labels;
            patch.push_back({y + dy, x + dx});
          }
      }
    for (int k = 1; k <= labels; ++k) {
      const double share = (label == k).select(all, 0).sum() / area;
      if (share > 0.04 && share < 0.6) hide(*inside, *around, label, k, block);
    }
    const double share = hidden_share(at);
    if (share > 0.05 && share < 0.5) return true;
    std::fill(hidden_.begin(), hidden_.end(), std::uint8_t{0});
    return false;
  }

  /// Marks a patch and what is of its colours around it as hidden, if it goes on outside.
  void hide(const Silhouette& inside, const Silhouette& around, const Eigen::ArrayXXi& label, int k,
            int block) {
    Eigen::VectorXf patch = Eigen::VectorXf::Zero(bin_count), object = patch;
    visit(inside, [&](int px, int py) {
      if (!seen(px, py)) return;
      const int here = label((py - top_) / block, (px - left_) / block);
      (here == k ? patch : object)[bin(px, py)] += here == k || here == 0 ? 1.f : 0.f;
    });
    smooth(patch);
    smooth(object);
    const auto of_patch = [&](int px, int py) {
      const auto b = bin(px, py);
      return patch[b] > 2 * frame_.bin_share[b] && patch[b] > 2 * object[b];
    };
    // Does it cross the outline? Of the pixels just outside, beside the patch, many are like it.
    int beside = 0, alike = 0;
    visit(around, [&](int px, int py) {
      const int row = (py - top_) / block, column = (px - left_) / block;
      if (frame_.taken.values[frame_.colours.index(px, py)]) return;
      const std::size_t line = static_cast<std::size_t>(py - inside.top);
      const bool within = py >= inside.top && line < inside.rows.size() &&
                          px >= inside.rows[line].left && px < inside.rows[line].right;
      if (within) return;
      for (int r = std::max(0, row - 1); r <= std::min<int>(row + 1, int(label.rows()) - 1); ++r)
        for (int c = std::max(0, column - 1); c <= std::min<int>(column + 1, int(label.cols()) - 1);
             ++c)
          if (label(r, c) == k) {
            ++beside;
            alike += of_patch(px, py);
            return;
          }
    });
    if (beside == 0 || alike < 0.4 * beside) return;
    visit(around, [&](int px, int py) {
      if (label((py - top_) / block, (px - left_) / block) == k || of_patch(px, py))
        hidden_[local(px, py)] = 1;
    });
  }

  /// The width and the height with which the outline holds most evidence, each by itself.
  Eigen::Vector2d measure(const Evidence& evidence, const Standing& at) const {
    const auto best = [&](bool height) {
      double most = -1e18, ratio = 1;
      for (int k = -8; k <= 8; ++k) {
        const double factor = std::exp(0.05 * k);  // 0.67 to 1.5
        model::Shape changed = shape_;
        if (height || shape_.kind == model::ShapeKind::sphere) changed.size.z() *= factor;
        if (!height || shape_.kind == model::ShapeKind::sphere) changed.size.head<2>() *= factor;
        const auto region = silhouette(camera_, changed, at);
        const double value = region ? evidence.sum(*region) : -1e18;
        // Of equals the one nearest to what is known.
        if (value > most + 1e-9 || (value > most - 1e-9 && factor <= 1)) {
          most = value;
          ratio = factor;
        }
      }
      return ratio;
    };
    return {best(false), best(true)};
  }

  double contrast(const Standing& at) const {
    const auto polygon = outline(camera_, shape_, at);
    if (!polygon) return 0;
    return outline_contrast(frame_.picture, *polygon, [&](int px, int py) {
      return px < left_ || py < top_ || px >= right_ || py >= bottom_ || seen(px, py);
    });
  }

  double hidden_share(const Standing& at) const {
    const auto region = silhouette(camera_, shape_, at);
    if (!region) return 0;
    int all = 0, hidden = 0;
    visit(*region, [&](int px, int py) {
      ++all;
      hidden += hidden_[local(px, py)];
    });
    return all > 0 ? static_cast<double>(hidden) / all : 0;
  }

  double wrap(double yaw) const {
    const double period = yaw_period(shape_);
    return period > 0 ? std::remainder(yaw, period) : 0;
  }

  /// Room for evidence around a hypothesis that only moves a little any more.
  Evidence nearby(const Standing& at) const {
    const auto around = silhouette(camera_, shape_, at, 0.06);
    if (!around) return Evidence(left_, top_, right_ - left_, bottom_ - top_);
    int low = right_, high = left_;
    for (const Silhouette::Span& span : around->rows) {
      if (span.right <= span.left) continue;
      low = std::min(low, span.left);
      high = std::max(high, span.right);
    }
    // Below, the outline does not grow with the margin: some rows for moving nearer.
    const int first = std::clamp(around->top, top_, bottom_);
    const int last =
        std::clamp(around->top + static_cast<int>(around->rows.size()) + 30, first, bottom_);
    low = std::clamp(low, left_, right_);
    high = std::clamp(high, low, right_);
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
    left_ = limit(low_x, camera_.width);
    right_ = limit(high_x + 1, camera_.width);
    top_ = limit(low_y, camera_.height);
    bottom_ = limit(high_y + 1, camera_.height);
    return right_ - left_ > 4 && bottom_ - top_ > 4;
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

  double score(const Evidence& evidence, const Standing& at) const {
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
          const Standing at{x + dx, y + dy, turns > 1 ? period * k / turns : 0};
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
    const Standing start = candidate.at;
    candidate.score = score(evidence, start);
    for (int i = -2; i <= 2; ++i)
      for (int j = -2; j <= 2; ++j) {
        const Standing at{start.x + 0.02 * i, start.y + 0.02 * j, start.yaw};
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
          const Standing at{candidate.at.x + dx, candidate.at.y + dy, candidate.at.yaw + dyaw};
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
  void reestimate(Evidence& evidence, const Standing& at) const {
    const auto inside = silhouette(camera_, shape_, at);
    const auto near = silhouette(camera_, shape_, at, 0.004);
    const auto around = silhouette(camera_, shape_, at, 0.05);
    if (!inside || !near || !around) return;
    Eigen::VectorXf object = Eigen::VectorXf::Zero(bin_count), ring = object;
    visit(*inside, [&](int px, int py) { object[bin(px, py)] += free(px, py); });
    visit(*around, [&](int px, int py) { ring[bin(px, py)] += free(px, py); });
    visit(*near, [&](int px, int py) { ring[bin(px, py)] -= free(px, py); });
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
  double agreement(const Standing& at, Yes yes) const {
    const auto region = silhouette(camera_, shape_, at);
    const auto around = silhouette(camera_, shape_, at, 0.03);
    if (!region || !around) return 0;
    const auto count = [&](const Silhouette& r, bool all) {
      int sum = 0;
      visit(r, [&](int px, int py) { sum += seen(px, py) && (all || yes(px, py)); });
      return sum;
    };
    const int inside = count(*region, false);
    const int united = count(*region, true) + std::max(0, count(*around, false) - inside);
    return united > 0 ? static_cast<double>(inside) / united : 0;
  }
  double first_agreement(const Standing& at) const {
    return agreement(at, [&](int px, int py) { return initial_[local(px, py)] > 0; });
  }

  /// From the curvature of the score at its maximum. Neighbouring pixels repeat each other, so a
  /// score counts for a tenth; eight tenths of a millimetre and half a degree are the least that is
  /// claimed.
  Eigen::Matrix3d covariance(const Evidence& evidence, const Candidate& best) const {
    const Eigen::Vector3d h(0.004, 0.004, 0.07);
    const auto value = [&](const Eigen::Vector3d& d) {
      return 0.1 * score(evidence, {best.at.x + d.x(), best.at.y + d.y(), best.at.yaw + d.z()});
    };
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    const double middle = value(Eigen::Vector3d::Zero());
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j) {
        Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = a;
        a[i] = h[i];
        b[j] = h[j];
        const double second =
            i == j ? value(a) - 2 * middle + value(-a)
                   : (value(a + b) - value(a - b) - value(b - a) + value(-a - b)) / 4;
        information(i, j) = information(j, i) = -second / (h[i] * h[j]);
      }
    if (!information.allFinite()) information.setZero();
    // Clamp to what is positive and within what was searched: 5 cm and a quarter turn at most.
    Eigen::Matrix3d scaled = h.asDiagonal() * information * h.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scaled);
    const Eigen::Vector3d kept = eigen.eigenvalues().cwiseMax(0.01);
    const Eigen::Matrix3d inverse =
        eigen.eigenvectors() * kept.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
    Eigen::Matrix3d made = h.asDiagonal() * inverse * h.asDiagonal();
    made.diagonal() += Eigen::Vector3d(6e-7, 6e-7, 6e-5);
    if (yaw_period(shape_) == 0) {
      made.row(2).setZero();
      made.col(2).setZero();
      made(2, 2) = pi * pi / 3;  // any turn
    }
    return made;
  }

  const Frame& frame_;
  const CameraModel& camera_;
  const model::Shape& shape_;
  const Eigen::VectorXf& known_;
  int left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;  // the area that is looked at, px
  std::vector<float> initial_;                       // evidence before re-estimation
  std::vector<std::uint8_t> hidden_;                 // 1: something stands before the object
};

}  // namespace

std::optional<Fit> localise(const Frame& frame, const CameraModel& camera,
                            const model::Shape& shape, const Eigen::VectorXf& known_colours,
                            double x, double y, double reach) {
  if (!model::is_valid(shape) || known_colours.size() != frame.colour_share.size())
    return std::nullopt;
  if (camera.width != frame.picture.width || camera.height != frame.picture.height)
    return std::nullopt;
  return Fitter(frame, camera, shape, known_colours).run(x, y, reach);
}

}  // namespace prehend::recognition
