#include "services/recognition/core/scan/scan.hpp"

#include <algorithm>
#include <cmath>

#include "services/recognition/core/scan/window_sums.hpp"

namespace prehend::recognition {

namespace {

using Counts = std::vector<std::uint16_t>;
using Numbers = std::vector<std::int16_t>;

constexpr float window_unit = 128;      // of the root of a count: 2^7 (2^16)^(1/2) fits 16 bits
constexpr float prototype_unit = 8192;  // of a number of a prototype

std::int32_t dot(const std::int16_t* a, const std::int16_t* b, std::size_t n) {
  std::int32_t sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += std::int32_t{a[i]} * std::int32_t{b[i]};
  return sum;
}

/// Roots of counts: 16 bits again. Eigen's roots are vectors of four whatever the flags.
void roots(const Counts& counts, Numbers& made) {
  using In = Eigen::Map<const Eigen::Array<std::uint16_t, Eigen::Dynamic, 1>>;
  using Out = Eigen::Map<Eigen::Array<std::int16_t, Eigen::Dynamic, 1>>;
  const auto n = static_cast<Eigen::Index>(counts.size());
  Out(made.data(), n) =
      (In(counts.data(), n).cast<float>().sqrt() * window_unit).cast<std::int16_t>();
}

/// The prototypes of all classes as the scan compares them: weighted by what is rare in this
/// picture, in 16 bits. Numbers are not negative, so the largest of each bin over the views of a
/// class bounds what any of them can score.
class Prototypes {
 public:
  Prototypes(const ObjectModels& models, const Eigen::VectorXf& weight, int padded)
      : padded_(static_cast<std::size_t>(padded)) {
    for (const ObjectClass& c : models.classes) {
      first_.push_back(rows_.size() / padded_);
      std::vector<std::int16_t> bound(padded_, 0);
      for (Eigen::Index k = 0; k < c.prototypes.cols(); ++k) {
        const Eigen::VectorXf weighted = weight.cwiseProduct(c.prototypes.col(k));
        const float norm = std::sqrt(weighted.dot(c.prototypes.col(k)));
        // A model of nothing but table colours keeps a floor, else noise in its rest would decide.
        const float scale = prototype_unit / std::max(norm, 0.35f);
        for (std::size_t b = 0; b < padded_; ++b) {
          const float value = b < static_cast<std::size_t>(weighted.size())
                                  ? weighted[static_cast<Eigen::Index>(b)]
                                  : 0.f;
          rows_.push_back(
              static_cast<std::int16_t>(std::lround(std::clamp(scale * value, 0.f, 32767.f))));
          bound[b] = std::max(bound[b], rows_.back());
        }
      }
      bounds_.insert(bounds_.end(), bound.begin(), bound.end());
    }
    first_.push_back(rows_.size() / padded_);
  }

  std::size_t classes() const { return first_.size() - 1; }
  /// No view of the class scores higher with these roots.
  std::int32_t bound(std::size_t c, const Numbers& window) const {
    return dot(&bounds_[c * padded_], window.data(), padded_);
  }
  /// The best view's score.
  std::int32_t score(std::size_t c, const Numbers& window) const {
    std::int32_t best = 0;
    for (std::size_t k = first_[c]; k < first_[c + 1]; ++k)
      best = std::max(best, dot(&rows_[k * padded_], window.data(), padded_));
    return best;
  }

 private:
  std::size_t padded_;
  Numbers rows_, bounds_;
  std::vector<std::size_t> first_;  // row of each class
};

/// Pairs as common as `common` in the whole picture count half.
Eigen::VectorXf rarity(const Eigen::VectorXf& total, double common) {
  if (!(common > 0) || !(total.sum() > 0)) return Eigen::VectorXf::Ones(total.size());
  const auto share = static_cast<float>(common);
  return (share / (share + (total / total.sum()).array())).matrix();
}

/// Looks at all windows of one size and lets them vote.
class Sweep {
 public:
  Sweep(const WindowSums& sums, const Prototypes& prototypes, const ScanOptions& options,
        Votes& votes)
      : sums_(sums),
        prototypes_(prototypes),
        options_(options),
        votes_(votes),
        counts_(static_cast<std::size_t>(sums.padded())),
        roots_(counts_.size()),
        bounds_(prototypes.classes()),
        scores_(prototypes.classes()) {}

  void run(int size) {
    const int across = sums_.columns() - size + 1, down = sums_.rows() - size + 1;
    if (across < 1 || down < 1) return;
    const int apart = options_.slack < 1 ? std::max(1, size / 3) : 1;
    if (apart == 1) {
      for (int y = 0; y < down; ++y)
        for (int x = 0; x < across; ++x) vote(x, y, size);
      return;
    }
    Plane promising(across, down);
    for (int y = 0; y < down + apart - 1; y += apart)
      for (int x = 0; x < across + apart - 1; x += apart) {
        const int column = std::min(x, across - 1), row = std::min(y, down - 1);
        if (!promises(column, row, size)) continue;
        const int reach = (apart + 1) / 2;
        for (int v = std::max(0, row - reach); v <= std::min(down - 1, row + reach); ++v)
          for (int u = std::max(0, column - reach); u <= std::min(across - 1, column + reach); ++u)
            promising.at(u, v) = 1;
      }
    for (int y = 0; y < down; ++y)
      for (int x = 0; x < across; ++x)
        if (promising.at(x, y)) vote(x, y, size);
  }

 private:
  /// Makes the window's roots; returns what a score of 1 is in their units, 0 for an empty window.
  float load(int column, int row, int size) {
    const std::uint32_t pairs = sums_.window(column, row, size, counts_);
    if (pairs == 0) return 0;
    roots(counts_, roots_);
    return window_unit * prototype_unit * std::sqrt(static_cast<float>(pairs));
  }

  bool promises(int column, int row, int size) {
    const float unit = load(column, row, size);
    const auto least =
        static_cast<std::int32_t>(static_cast<float>(options_.min_score - options_.slack) * unit);
    for (std::size_t c = 0; unit > 0 && c < prototypes_.classes(); ++c)
      if (prototypes_.bound(c, roots_) >= least) return true;
    return false;
  }

  void vote(int column, int row, int size) {
    const float unit = load(column, row, size);
    if (!(unit > 0)) return;
    for (std::size_t c = 0; c < bounds_.size(); ++c) bounds_[c] = prototypes_.bound(c, roots_);
    // The most promising class first: what it scores rules most others out.
    const auto likely = static_cast<std::size_t>(std::max_element(bounds_.begin(), bounds_.end()) -
                                                 bounds_.begin());
    std::fill(scores_.begin(), scores_.end(), 0.f);
    float winner = 0;
    const auto look = [&](std::size_t c) {
      const float enough = std::max(static_cast<float>(options_.min_score), 0.9f * winner);
      if (static_cast<float>(bounds_[c]) < enough * unit) return;
      scores_[c] = static_cast<float>(prototypes_.score(c, roots_)) / unit;
      winner = std::max(winner, scores_[c]);
    };
    look(likely);
    for (std::size_t c = 0; c < scores_.size(); ++c)
      if (c != likely) look(c);
    if (winner < options_.min_score) return;
    // Each size of window has the same say in a cell, or large windows would outvote what is small.
    const auto area = static_cast<float>(size * size);
    for (std::size_t c = 0; c < scores_.size(); ++c) {
      if (scores_[c] <= 0.9f * winner) continue;
      votes_.classes[c].block(row, column, size, size).array() += scores_[c] * scores_[c] / area;
      if (scores_[c] > votes_.best[c].score)
        votes_.best[c] = {column * votes_.cell_size, row * votes_.cell_size,
                          size * votes_.cell_size, scores_[c]};
    }
  }

  const WindowSums& sums_;
  const Prototypes& prototypes_;
  const ScanOptions& options_;
  Votes& votes_;
  Counts counts_;
  Numbers roots_;
  std::vector<std::int32_t> bounds_;
  std::vector<float> scores_;
};

}  // namespace

Votes scan(const ObjectModels& models, const Plane& colours, const ScanOptions& options,
           const Plane& taken) {
  Plane coarse(colours.width, colours.height);
  std::transform(colours.values.begin(), colours.values.end(), coarse.values.begin(),
                 [&](std::uint8_t c) { return static_cast<std::uint8_t>(models.coarse[c]); });
  if (taken.values.size() == coarse.values.size())
    for (std::size_t i = 0; i < coarse.values.size(); ++i)
      if (taken.values[i]) coarse.values[i] = 255;
  Votes votes{colours.width / options.cell_size,
              colours.height / options.cell_size,
              options.cell_size,
              {},
              std::vector<Match>(models.classes.size())};
  for (std::size_t c = 0; c < models.classes.size(); ++c)
    votes.classes.push_back(Eigen::MatrixXf::Zero(votes.rows, votes.columns));
  if (votes.columns == 0 || votes.rows == 0) return votes;
  for (const double scale : options.scales) {
    std::vector<int> sizes, distances;
    for (const int size : options.windows)
      sizes.push_back(std::max(1, static_cast<int>(std::lround(size * scale))));
    for (const int distance : models.distances)
      distances.push_back(std::max(1, static_cast<int>(std::lround(distance * scale))));
    const WindowSums sums(coarse, models.coarse_colours, offsets_at(distances), options.cell_size,
                          options.step, *std::max_element(sizes.begin(), sizes.end()));
    const Prototypes prototypes(models, rarity(sums.total(), options.common), sums.padded());
    Sweep sweep(sums, prototypes, options, votes);
    for (const int size : sizes) sweep.run(size);
  }
  return votes;
}

Region grow_strongest(const Votes& votes, const Plane& open) {
  Region region;
  Eigen::Index row = 0, column = 0;
  for (std::size_t c = 0; c < votes.classes.size(); ++c)
    for (int k = 0; k < votes.columns; ++k)
      for (int r = 0; r < votes.rows; ++r) {
        if (!open.values.empty() && (k >= open.width || r >= open.height || !open.at(k, r)))
          continue;
        const float strength = votes.classes[c](r, k);
        if (strength <= region.strength) continue;
        region.strength = strength;
        region.class_index = static_cast<int>(c);
        row = r;
        column = k;
      }
  if (region.class_index < 0) return region;
  const Eigen::MatrixXf& matrix = votes.classes[static_cast<std::size_t>(region.class_index)];
  Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> seen(votes.rows, votes.columns);
  seen.setConstant(false);
  region.cells.push_back({static_cast<int>(column), static_cast<int>(row)});
  seen(row, column) = true;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double mass = 0;
  region.left = region.top = 1 << 20;
  for (std::size_t i = 0; i < region.cells.size(); ++i) {
    const Eigen::Vector2i cell = region.cells[i];
    const double votes_here = matrix(cell.y(), cell.x());
    sum += votes_here * ((cell.cast<double>().array() + 0.5) * votes.cell_size - 0.5).matrix();
    mass += votes_here;
    region.left = std::min(region.left, cell.x() * votes.cell_size);
    region.top = std::min(region.top, cell.y() * votes.cell_size);
    region.right = std::max(region.right, (cell.x() + 1) * votes.cell_size);
    region.bottom = std::max(region.bottom, (cell.y() + 1) * votes.cell_size);
    for (const Eigen::Vector2i& step : {Eigen::Vector2i(1, 0), Eigen::Vector2i(-1, 0),
                                        Eigen::Vector2i(0, 1), Eigen::Vector2i(0, -1)}) {
      const Eigen::Vector2i next = cell + step;
      if (next.x() < 0 || next.y() < 0 || next.x() >= votes.columns || next.y() >= votes.rows)
        continue;
      if (seen(next.y(), next.x()) || matrix(next.y(), next.x()) < 0.5f * region.strength) continue;
      seen(next.y(), next.x()) = true;
      region.cells.push_back(next);
    }
  }
  region.centre = sum / mass;
  return region;
}

void erase(Votes& votes, int left, int top, int right, int bottom) {
  const int x0 = std::clamp(left / votes.cell_size, 0, votes.columns);
  const int y0 = std::clamp(top / votes.cell_size, 0, votes.rows);
  const int x1 = std::clamp((right + votes.cell_size - 1) / votes.cell_size, x0, votes.columns);
  const int y1 = std::clamp((bottom + votes.cell_size - 1) / votes.cell_size, y0, votes.rows);
  for (Eigen::MatrixXf& matrix : votes.classes) matrix.block(y0, x0, y1 - y0, x1 - x0).setZero();
}

}  // namespace prehend::recognition
