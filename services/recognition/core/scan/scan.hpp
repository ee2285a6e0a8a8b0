#pragma once

#include <vector>

#include "services/recognition/core/learning/object_models.hpp"

namespace prehend::recognition {

struct ScanOptions {
  int cell_size = 10;                     // px, side of the cells of which windows are made
  int step = 2;                           // every step-th pixel starts a pair
  std::vector<int> windows = {3, 6, 10};  // sides of the sub-windows, cells
  /// Sizes at which an object may be seen, as shares of that in training: the pairs' distances and
  /// the sub-windows grow with it.
  std::vector<double> scales = {1.0};
  /// Pairs of colours as common as this share in the whole picture count half: they are table. 0:
  /// no such discount, for pictures that one object fills.
  double common = 0.01;
  double min_score = 0.35;  // a window that resembles nothing better votes for nothing
  /// Every third of a window's side one is looked at first; those near it follow when no class is
  /// further than this below the least score. 1: all windows are looked at.
  double slack = 0.12;
};

/// A sub-window and how much it resembles a class, 0..1.
struct Match {
  int left = 0, top = 0, side = 0;  // px
  float score = 0;
};

/// The vote matrix of every class: how much the sub-windows that cover a cell resemble it.
struct Votes {
  int columns = 0, rows = 0, cell_size = 0;
  std::vector<Eigen::MatrixXf> classes;  // rows by columns
  std::vector<Match> best;               // of each class, among the windows in which it has a vote
};

/// Compares overlapping sub-windows of several sizes with the scan's prototypes of all classes.
/// Each window votes in its cells for the classes that it resembles most (within a tenth of the
/// best). `taken`: pixels (1) that are left out because what they show is already known; may be
/// empty. All in 16-bit integers, so that every processor gives the same answer.
Votes scan(const ObjectModels& models, const Plane& colours, const ScanOptions& options = {},
           const Plane& taken = {});

/// Cells connected to the strongest one in which a class has at least half as many votes.
struct Region {
  int class_index = -1;
  float strength = 0;                            // votes of the strongest cell
  Eigen::Vector2d centre;                        // px, mean of the cells weighted by their votes
  int left = 0, top = 0, right = 0, bottom = 0;  // px, right and bottom exclusive
  std::vector<Eigen::Vector2i> cells;            // column, row
};

/// Grows the region of the strongest cell of all classes; only cells that are 1 in `open` (empty:
/// all) can be the strongest, but the region grows beyond them. None left: class_index is -1.
Region grow_strongest(const Votes& votes, const Plane& open = {});
/// Removes the votes of all classes in a rectangle of the picture, px.
void erase(Votes& votes, int left, int top, int right, int bottom);

}  // namespace prehend::recognition
