#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/recording/compare/tolerance.hpp"
#include "common/recording/types/value.hpp"

namespace prehend::recording {

/// Two recordings of the same thing: what is expected (the recorded one) and what is there now.
enum class Side { expected, actual };

/// A sample, or the end of an instance.
struct ComparedSample {
  std::string topic;
  /// By which it is decoded; without one the bytes are compared. Must outlive the comparison.
  const recording::types::Structure* type = nullptr;
  /// From the encapsulation on; empty for the end of an instance.
  std::span<const std::uint8_t> payload;
  /// «disposed» or «unregistered» with the instance, empty for data.
  std::string end;
};

/// One field that is not the same.
struct Difference {
  std::int64_t stamp_ns = 0;  // by which the sample was found: origin, else stamp, else its place
  std::string sample;         // which one, for people: «origin 12.345 s, hand right»
  std::string field;          // empty: the sample is missing on one side
  std::string expected;
  std::string actual;
  double tolerance = 0;

  /// «X_WB.position.z: expected 0.121, got 0.125 (tolerance 1e-06)»
  std::string text() const;
};

struct TopicReport {
  std::string name;
  std::uint64_t compared = 0;     // samples that are on both sides
  std::uint64_t different = 0;    // of these, plus those that are on one side only
  std::uint64_t missing = 0;      // not there now
  std::uint64_t extra = 0;        // not expected
  std::vector<Difference> first;  // the earliest ones
};

struct Report {
  std::vector<TopicReport> topics;  // by name
  bool same() const;
};

/// Compares samples topic by topic. They come in any order, one at a time; only those whose partner
/// has not come yet are kept. Partners have the same key fields and the same origin_ns where the
/// type has one that is not 0, else the same stamp_ns, else the same sequence_number, else the same
/// place; the nth of several such on one side belongs to the nth on the other. Not thread safe.
class Comparison {
 public:
  /// Keeps so many differences of each topic. The table must outlive it.
  explicit Comparison(const ToleranceTable& tolerances, std::size_t keep = 10);
  ~Comparison();

  void add(Side side, const ComparedSample& sample);
  /// Those without a partner count as different.
  Report finish();

 private:
  struct Topic;
  const ToleranceTable& tolerances_;
  std::size_t keep_;
  std::map<std::string, std::unique_ptr<Topic>> topics_;
};

}  // namespace prehend::recording
