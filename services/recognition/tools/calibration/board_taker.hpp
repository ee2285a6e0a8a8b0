#pragma once

#include <string>

#include "services/recognition/tools/calibration/calibrate.hpp"

namespace prehend::recognition {

/// Chooses views for a calibration from a running camera: first one of the board lying still, then
/// as many others as are wanted, each well apart from those before. Says what it waits for.
class BoardTaker {
 public:
  /// `wanted` views in all, at least 1.
  BoardTaker(const Chessboard& board, int wanted) : board_(board), wanted_(wanted) {}

  /// True when the picture was taken as a view.
  bool see(const Picture& picture);
  bool done() const { return static_cast<int>(views_.size()) >= wanted_; }
  const std::vector<BoardView>& views() const { return views_; }
  /// What to do for the next view.
  const std::string& hint() const { return hint_; }

 private:
  Chessboard board_;
  int wanted_;
  int still_ = 0;  // pictures in a row in which the board did not move
  BoardView last_;
  std::vector<BoardView> views_;
  std::string hint_ = "lay the board on the table, printed side up";
};

}  // namespace prehend::recognition
