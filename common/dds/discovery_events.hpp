#pragma once

#include <cstdint>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/dds/guard/packet.hpp"
#include "common/dds/release/fastdds.hpp"
#include "common/dds/topic.hpp"

namespace prehend::dds {

enum class News : std::uint8_t { found, changed, gone };

/// The part of an identity that all of a participant share.
GuidPrefix prefix_of(const rtps::GuidPrefix_t& from);

/// A peer, as discovery tells of it.
struct FoundParticipant {
  News news{};
  rtps::GUID_t guid;
  std::string name;
  std::string middleware;    // what it speaks with, as «Fast DDS 3.1.2»; empty: it does not tell
  std::optional<Role> role;  // as it announces it
  bool secured = false;      // it has keys; Fast DDS 3 does not show it, nor what follows
  std::string authority;     // of its keys
  std::string certificate;   // whose they are
};

/// A writer or reader of a peer.
struct FoundEndpoint {
  News news{};
  bool writes = false;
  rtps::GUID_t guid;
  std::string topic, type;
  bool keyed = false;
  TopicQos qos;  // without depths: discovery does not tell of them
  std::vector<std::string> rigs;
};

/// What discovery tells, alike for every release of Fast DDS, whose calls differ. In its threads,
/// where no endpoint may be made.
class DiscoveryEvents : public fdds::DomainParticipantListener {
 public:
  using Guid = rtps::GUID_t;
  virtual void on_participant(const FoundParticipant&) {}
  virtual void on_endpoint(const FoundEndpoint&) {}
  /// In a secured lab: is the peer let in, or refused? Fast DDS 2.9 tells of a peer before this,
  /// 3.1 after it.
  virtual void on_judged(const Guid&, bool /*let_in*/) {}

 private:
  using DomainParticipant = fdds::DomainParticipant;
  void onParticipantAuthentication(DomainParticipant*,
                                   rtps::ParticipantAuthenticationInfo&& info) final;
#if PREHEND_FAST_DDS == 2
  void on_participant_discovery(DomainParticipant*, rtps::ParticipantDiscoveryInfo&& found) final;
  void on_publisher_discovery(DomainParticipant*, rtps::WriterDiscoveryInfo&& found) final;
  void on_subscriber_discovery(DomainParticipant*, rtps::ReaderDiscoveryInfo&& found) final;
#else
  void on_participant_discovery(DomainParticipant*, rtps::ParticipantDiscoveryStatus status,
                                const rtps::ParticipantBuiltinTopicData& info, bool& ignored) final;
  void on_data_writer_discovery(DomainParticipant*, rtps::WriterDiscoveryStatus status,
                                const rtps::PublicationBuiltinTopicData& info, bool& ignored) final;
  void on_data_reader_discovery(DomainParticipant*, rtps::ReaderDiscoveryStatus status,
                                const rtps::SubscriptionBuiltinTopicData& info,
                                bool& ignored) final;
#endif
};

}  // namespace prehend::dds
