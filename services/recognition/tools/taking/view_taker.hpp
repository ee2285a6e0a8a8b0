#pragma once

#include <string>

#include "services/recognition/core/learning/training.hpp"

namespace prehend::recognition {

/// Cuts views of one object out of a steady camera's pictures: first the empty table is learned,
/// then every time that the picture comes to rest, what is new on the table is a view, if it shows
/// more than the last one did. Shadows count as table. A thing that reaches the picture's edge is a
/// hand, and is waited for. Pure: pictures in, views out. Says what it waits for.
class ViewTaker {
 public:
  /// `wanted` views, at least 1.
  explicit ViewTaker(int wanted) : wanted_(wanted) {}

  /// True when the picture gave a view. A picture of another size starts everything anew.
  bool see(const Picture& picture);
  bool done() const { return static_cast<int>(views_.size()) >= wanted_; }
  /// Crops at the size of the picture, each with the object's mask.
  const std::vector<TrainingView>& views() const { return views_; }
  /// What to do now.
  const std::string& hint() const { return hint_; }

 private:
  bool learn_table(const Picture& picture);
  bool rests(const Picture& picture);
  bool take(const Picture& picture, const Plane& mask, int left, int top, int width, int height);

  int wanted_;
  int still_ = 0;  // pictures in a row that were like the one before
  int empty_ = 0;  // of the table, summed
  std::vector<float> table_;
  Picture before_, taken_;
  std::vector<TrainingView> views_;
  std::string hint_ = "clear the table and keep out of the picture";
};

}  // namespace prehend::recognition
