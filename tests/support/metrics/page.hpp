#pragma once

#include <map>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace prehend::tests {

/// A page in the text format of Prometheus, version 0.0.4, as a reader that lets nothing pass sees
/// it.
struct MetricsPage {
  std::map<std::string, std::string> types;  // gauge or counter, by family
  std::map<std::string, double> samples;     // by name and labels, as they are written

  /// Fails where the page is not what its format wants: names, types, order, labels, numbers, or a
  /// sample that is there twice.
  static Expected<MetricsPage> parse(std::string_view text);

  /// The value of the one sample of this name whose labels contain the text. Fails: none, or
  /// several.
  Expected<double> value(std::string_view name, std::string_view labels = {}) const;
  /// The first counter that is there and was higher before; empty: none.
  std::string shrunk_since(const MetricsPage& before) const;
};

}  // namespace prehend::tests
