#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace prehend::cli {

/// Numbers with names in the text format of Prometheus, version 0.0.4. What is said twice of the
/// same labels is one sample, or a reader would refuse all of them: counts are added up, of other
/// numbers the last one counts.
class Exposition {
 public:
  using Labels = std::vector<std::pair<std::string_view, std::string>>;

  /// Names a family, of which the samples that follow are. Names are ours, label values anybody's.
  void gauge(std::string_view name, std::string_view help);
  /// The name ends in _total.
  void counter(std::string_view name, std::string_view help);

  void number(const Labels& labels, double value);
  void count(const Labels& labels, std::uint64_t value);

  std::string text() const;

 private:
  struct Family {
    std::string name, type, help;
    std::map<std::string, double> numbers;  // by labels
    std::map<std::string, std::uint64_t> counts;
  };
  std::vector<Family> families_;
};

}  // namespace prehend::cli
