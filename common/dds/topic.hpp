#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "common/dds/release/fastdds.hpp"
#include "common/dds/release/role.hpp"

/// What there is to say of one topic; the topics themselves are in topics.hpp.
namespace prehend::dds {

/// What both ends of a topic must agree on.
struct TopicQos {
  bool reliable = true;
  bool transient_local = false;
  /// Samples kept by a writer and by a reader for each instance; 0: all.
  int writer_depth = 1;
  int reader_depth = 1;
  bool exclusive_ownership = false;       // one writer at a time moves an instance
  std::chrono::milliseconds deadline{0};  // 0: none
  std::chrono::milliseconds lifespan{0};  // 0: for ever
  std::string_view user_data{};           // what an endpoint says of itself; stays in memory
};

/// What a topic is about.
enum class Content : std::uint8_t {
  data,      // measured or computed: in lockstep the same inputs give the same samples
  order,     // what an operator asks for, and the replies
  lockstep,  // the common clock of services that run in lockstep
  process,   // what a process says of itself: true while it lives, so it is never replayed
};

/// Everything about a topic but the C++ type of its samples.
struct TopicInfo {
  std::string_view name;
  TopicQos qos;
  /// Roles with a reader or writer of this type in their code. Key permissions follow from them.
  Roles writers, readers;
  /// Whoever is in the lab may read it as well.
  bool open = false;
  Content content = Content::data;
  /// For people, in the table of idl/README.md.
  std::string_view rate, remark;
  /// As the IDL has them; set by Topic.
  std::string (*type_name)() = nullptr;  // with scope, as in discovery: prehend::v2::HandCommand
  bool (*keyed)() = nullptr;
};

/// A topic with the C++ type of its samples, so that a name is never paired with a wrong type.
template <class PubSub>
struct Topic : TopicInfo {
  using PubSubType = PubSub;
  using Type = typename PubSub::type;
  constexpr explicit Topic(const TopicInfo& info) : TopicInfo(info) {
    type_name = [] { return name_of(PubSub()); };
    keyed = [] { return has_key(PubSub()); };
  }
};

/// Beside its writers, a replayer writes every topic.
constexpr bool may_write(Role role, const TopicInfo& topic) {
  return topic.writers.has(role) || role == Role::replayer;
}
/// Beside its readers, who only looks reads every topic.
constexpr bool may_read(Role role, const TopicInfo& topic) {
  return topic.readers.has(role) || topic.open ||
         (Role::recorder | Role::replayer | Role::viewer | Role::console).has(role);
}

/// Does what this role computes depend on the topic?
constexpr bool is_input(Role role, const TopicInfo& topic) {
  return topic.readers.has(role) &&
         (topic.content == Content::data || topic.content == Content::order);
}
/// Does this role compute what is on the topic? What it also reads is what its device measured.
constexpr bool is_output(Role role, const TopicInfo& topic) {
  return topic.writers.has(role) && !topic.readers.has(role) && topic.content == Content::data;
}

}  // namespace prehend::dds
