#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace prehend::recognition {

/// One picture of which is known what it shows, and what it was taken for.
struct Judged {
  std::filesystem::path file;
  int truth = -1;          // index of its class; -1: of none, a stranger
  int best = -1;           // index of the class it was taken for; -1: none
  double probability = 0;  // that this is right, as the classifier says
  bool right() const { return truth >= 0 && best == truth; }
};

/// How often each class (row) was taken for each (column); strangers are left out, and so are
/// pictures that were taken for nothing.
std::vector<std::vector<int>> confusion(std::span<const Judged> pictures, std::size_t classes);

/// The probability that lets through this share of the pictures that are no strangers.
double threshold_for(std::span<const Judged> pictures, double share);

/// What comes through a threshold.
struct Accepted {
  std::size_t known = 0, known_accepted = 0, wrong_accepted = 0;  // pictures of trained objects
  std::size_t strangers = 0, strangers_rejected = 0;
};
Accepted accept(std::span<const Judged> pictures, double threshold);

/// Pictures whose probability lies in one of ten equal parts of 0..1: what was said and what held.
struct Bin {
  double said = 0, held = 0;  // mean probability; share that was right
  std::size_t count = 0;
};
std::vector<Bin> reliability(std::span<const Judged> pictures);

/// Mean square of probability minus outcome (Brier 1950); 0 is perfect.
double brier(std::span<const Judged> pictures);

}  // namespace prehend::recognition
