#include "common/dds/discovery_events.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/dds/release/user_data.hpp"

namespace prehend::dds {

namespace {

std::chrono::milliseconds milliseconds_of(const DdsDuration& period) {
  if (period == endless) return std::chrono::milliseconds(0);
  return std::chrono::milliseconds(period.to_ns() / 1'000'000);
}

template <class Policies>
TopicQos qos_of(const Policies& policies) {
  TopicQos qos;
  qos.reliable = policies.reliability.kind == fdds::RELIABLE_RELIABILITY_QOS;
  // Whatever lasts longer than transient local we can neither ask for nor offer.
  qos.transient_local = policies.durability.kind != fdds::VOLATILE_DURABILITY_QOS;
  qos.exclusive_ownership = policies.ownership.kind == fdds::EXCLUSIVE_OWNERSHIP_QOS;
  qos.deadline = milliseconds_of(policies.deadline.period);
  return qos;
}

News news_of(auto status, auto found, auto changed) {
  return status == found ? News::found : status == changed ? News::changed : News::gone;
}

/// Printable, and no longer than a word: it comes from the network.
std::string word(const auto& bytes) {
  constexpr std::size_t max_size = 40;
  std::string text;
  for (const auto byte : bytes)
    if (text.size() < max_size && byte >= ' ' && byte <= '~') text += static_cast<char>(byte);
  return text;
}

/// Other implementations are told by the number of their maker (DDSI-RTPS 2.3, 9.3.2).
std::string middleware_of(const auto& vendor, const std::string& announced) {
  if (!announced.empty()) return announced;
  if (vendor[0] != 1) return {};
  switch (vendor[1]) {
    case 0x01:
      return "Connext";
    case 0x03:
      return "OpenDDS";
    case 0x0f:
      return "Fast DDS";
    case 0x10:
      return "Cyclone DDS";
    default:
      return fmt::format("maker 1.{}", vendor[1]);
  }
}

#if PREHEND_FAST_DDS == 2

/// The policies of an endpoint by the names that Fast DDS 3.1 has for them.
struct Policies {
  const fdds::ReliabilityQosPolicy& reliability;
  const fdds::DurabilityQosPolicy& durability;
  const fdds::OwnershipQosPolicy& ownership;
  const fdds::DeadlineQosPolicy& deadline;
};

FoundEndpoint endpoint(News news, bool writes, const auto& info) {
  const auto& qos = info.m_qos;
  return {news,
          writes,
          info.guid(),
          info.topicName().to_string(),
          info.typeName().to_string(),
          info.topicKind() == rtps::WITH_KEY,
          qos_of(Policies{qos.m_reliability, qos.m_durability, qos.m_ownership, qos.m_deadline}),
          qos.m_partition.getNames()};
}

#else

FoundEndpoint endpoint(News news, bool writes, const auto& info) {
  return {news,
          writes,
          info.guid,
          info.topic_name.to_string(),
          info.type_name.to_string(),
          info.topic_kind == rtps::TopicKind_t::WITH_KEY,
          qos_of(info),
          info.partition.getNames()};
}

#endif

}  // namespace

GuidPrefix prefix_of(const rtps::GuidPrefix_t& from) {
  GuidPrefix prefix;
  std::copy_n(from.value, prefix.size(), prefix.begin());
  return prefix;
}

void DiscoveryEvents::onParticipantAuthentication(DomainParticipant*,
                                                  rtps::ParticipantAuthenticationInfo&& info) {
  on_judged(info.guid, info.status == rtps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT);
}

#if PREHEND_FAST_DDS == 2

void DiscoveryEvents::on_participant_discovery(DomainParticipant*,
                                               rtps::ParticipantDiscoveryInfo&& found) {
  using Found = rtps::ParticipantDiscoveryInfo;
  const auto& info = found.info;
  FoundParticipant told;
  told.news = news_of(found.status, Found::DISCOVERED_PARTICIPANT, Found::CHANGED_QOS_PARTICIPANT);
  told.guid = info.m_guid;
  told.name = info.m_participantName.to_string();
  const UserData announced = read_user_data(word(info.m_userData.data_vec()));
  told.middleware = middleware_of(info.m_VendorId, announced.middleware);
  told.role = announced.role;
  for (const rtps::Property& property : info.identity_token_.properties()) {
    told.secured = true;
    if (property.name() == "dds.ca.sn") told.authority = property.value();
    if (property.name() == "dds.cert.sn") told.certificate = property.value();
  }
  on_participant(told);
}

void DiscoveryEvents::on_publisher_discovery(DomainParticipant*,
                                             rtps::WriterDiscoveryInfo&& found) {
  using Found = rtps::WriterDiscoveryInfo;
  FoundEndpoint told = endpoint(
      news_of(found.status, Found::DISCOVERED_WRITER, Found::CHANGED_QOS_WRITER), true, found.info);
  told.qos.lifespan = milliseconds_of(found.info.m_qos.m_lifespan.duration);
  on_endpoint(told);
}

void DiscoveryEvents::on_subscriber_discovery(DomainParticipant*,
                                              rtps::ReaderDiscoveryInfo&& found) {
  using Found = rtps::ReaderDiscoveryInfo;
  on_endpoint(endpoint(news_of(found.status, Found::DISCOVERED_READER, Found::CHANGED_QOS_READER),
                       false, found.info));
}

#else

void DiscoveryEvents::on_participant_discovery(DomainParticipant*,
                                               rtps::ParticipantDiscoveryStatus status,
                                               const rtps::ParticipantBuiltinTopicData& info,
                                               bool&) {
  using Status = rtps::ParticipantDiscoveryStatus;
  FoundParticipant told;
  told.news = news_of(status, Status::DISCOVERED_PARTICIPANT, Status::CHANGED_QOS_PARTICIPANT);
  told.guid = info.guid;
  told.name = info.participant_name.to_string();
  UserData announced = read_user_data(word(info.user_data.data_vec()));
  if (const auto& of = info.product_version; announced.middleware.empty() && of.major > 0)
    announced.middleware = fmt::format("Fast DDS {}.{}.{}", of.major, of.minor, of.patch);
  told.middleware = middleware_of(info.vendor_id, announced.middleware);
  told.role = announced.role;
  on_participant(told);
}

void DiscoveryEvents::on_data_writer_discovery(DomainParticipant*,
                                               rtps::WriterDiscoveryStatus status,
                                               const rtps::PublicationBuiltinTopicData& info,
                                               bool&) {
  using Status = rtps::WriterDiscoveryStatus;
  FoundEndpoint told =
      endpoint(news_of(status, Status::DISCOVERED_WRITER, Status::CHANGED_QOS_WRITER), true, info);
  told.qos.lifespan = milliseconds_of(info.lifespan.duration);
  on_endpoint(told);
}

void DiscoveryEvents::on_data_reader_discovery(DomainParticipant*,
                                               rtps::ReaderDiscoveryStatus status,
                                               const rtps::SubscriptionBuiltinTopicData& info,
                                               bool&) {
  using Status = rtps::ReaderDiscoveryStatus;
  on_endpoint(endpoint(news_of(status, Status::DISCOVERED_READER, Status::CHANGED_QOS_READER),
                       false, info));
}

#endif

}  // namespace prehend::dds
