#include "scan.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::recognition {

Votes scan(const ObjectModels& models, const Plane& colours, const ScanOptions& options,
           const Plane& taken) {
  Plane coarse(colours.width, colours.height);
  std::transform(colours.values.begin(), colours.values.end(), coarse.values.begin(),
                 [&](std::uint8_t c) { return static_cast<std::uint8_t>(models.coarse[c]); });
  if (taken.values.size() == coarse.values.size())
    for (std::size_t i = 0; i < coarse.values.size(); ++i)
      if (taken.values[i]) coarse.values[i] = 255;
  const CellGrid grid(coarse, models.coarse_colours, offsets_at(models.distances),
                      options.cell_size, options.step);
  Votes votes{grid.columns(), grid.rows(), options.cell_size, {}};
  for (std::size_t c = 0; c < models.classes.size(); ++c)
    votes.classes.push_back(Eigen::MatrixXf::Zero(grid.rows(), grid.columns()));
  if (grid.columns() == 0 || grid.rows() == 0) return votes;

  // Discount of what is everywhere in this picture.
  Eigen::VectorXf weight = Eigen::VectorXf::Ones(grid.bins());
  const Eigen::VectorXf total = grid.total();
  if (options.common > 0 && total.sum() > 0) {
    const auto common = static_cast<float>(options.common);
    weight = (common / (common + (total / total.sum()).array())).matrix();
  }
  Eigen::Index count = 0;
  for (const ObjectClass& c : models.classes) count += c.prototypes.cols();
  Eigen::MatrixXf prototypes(count, grid.bins());
  std::vector<std::size_t> owner;
  for (std::size_t c = 0; c < models.classes.size(); ++c)
    for (Eigen::Index k = 0; k < models.classes[c].prototypes.cols(); ++k) {
      const Eigen::VectorXf q = models.classes[c].prototypes.col(k);
      const Eigen::VectorXf weighted = weight.cwiseProduct(q);
      const float norm = std::sqrt(weighted.dot(q));
      // A model of nothing but table colours keeps a floor, else noise in its rest would decide.
      prototypes.row(static_cast<Eigen::Index>(owner.size())) =
          weighted.transpose() / std::max(norm, 0.35f);
      owner.push_back(c);
    }

  for (const int size : options.windows) {
    Eigen::MatrixXf windows = grid.windows(size, options.stride);
    if (windows.cols() == 0) continue;
    for (Eigen::Index i = 0; i < windows.cols(); ++i) {
      const float sum = windows.col(i).sum();
      if (sum > 0) windows.col(i) = (windows.col(i) / sum).cwiseSqrt();
    }
    const Eigen::MatrixXf scores = prototypes * windows;
    const int across = (grid.columns() - size) / options.stride + 1;
    std::vector<float> best(models.classes.size());
    for (Eigen::Index i = 0; i < scores.cols(); ++i) {
      std::fill(best.begin(), best.end(), 0.f);
      for (Eigen::Index k = 0; k < scores.rows(); ++k) {
        float& b = best[owner[static_cast<std::size_t>(k)]];
        b = std::max(b, scores(k, i));
      }
      const float winner = *std::max_element(best.begin(), best.end());
      if (winner < options.least_score) continue;
      const int x = static_cast<int>(i) % across * options.stride;
      const int y = static_cast<int>(i) / across * options.stride;
      for (std::size_t c = 0; c < best.size(); ++c)
        if (best[c] > 0.9f * winner)
          votes.classes[c].block(y, x, size, size).array() += best[c] * best[c];
    }
  }
  return votes;
}

Region grow_strongest(const Votes& votes) {
  Region region;
  Eigen::Index row = 0, column = 0;
  for (std::size_t c = 0; c < votes.classes.size(); ++c) {
    if (votes.classes[c].size() == 0) continue;
    Eigen::Index r, k;
    const float strength = votes.classes[c].maxCoeff(&r, &k);
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
