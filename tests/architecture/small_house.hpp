#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/architecture/agreed.hpp"

namespace prehend::architecture {

/// Text by path.
using Texts = std::map<std::string, std::string>;

/// A house of a few tiny files that keeps all rules.
Texts small_house();

/// What the small house has agreed on: an entry of each kind.
Agreed agreed_in_the_small_house();

/// How a rule is broken on purpose, and nothing else.
struct Break {
  std::string rule;
  std::string what;   // for people
  std::string named;  // the file that the rule must name
  Texts changes;      // to the small house; an empty text takes the file away
};

/// For every rule at least one.
std::vector<Break> breaks();

/// A tree in a temporary folder, which goes with it.
class Tree {
 public:
  explicit Tree(Texts texts);
  ~Tree();
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;

  const std::filesystem::path& root() const { return root_; }

  /// Writes these files; an empty text takes one away.
  void change(const Texts& changes);
  /// Makes these files what they were at first.
  void undo(const Texts& changes);

 private:
  Texts texts_;
  std::filesystem::path root_;
};

}  // namespace prehend::architecture
