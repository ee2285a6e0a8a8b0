#include "common/dds/participant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <map>
#include <mutex>
#include <set>

#include "common/base/log.hpp"
#include "common/dds/guard/guarded_transport.hpp"
#include "common/dds/guard/handshake_pause.hpp"
#include "common/dds/guard/serialized_transport.hpp"
#include "common/dds/guard/within_process.hpp"
#include "common/dds/peers.hpp"
#include "common/dds/release/user_data.hpp"
#include "common/dds/server_watch.hpp"
#include "common/dds/topics.hpp"

namespace prehend::dds {

namespace {

DdsDuration duration(std::chrono::milliseconds time) {
  return {static_cast<int32_t>(time.count() / 1000),
          static_cast<uint32_t>(time.count() % 1000) * 1'000'000u};
}

/// What a writer and a reader of one topic set alike.
template <class Qos>
void apply(Qos& qos, const TopicQos& contract, int depth, bool lockstep) {
  const bool all = depth == 0 || lockstep;
  qos.reliability().kind = contract.reliable || lockstep ? fdds::RELIABLE_RELIABILITY_QOS
                                                         : fdds::BEST_EFFORT_RELIABILITY_QOS;
  // In lockstep nothing may be missed by a service that is still being discovered.
  qos.durability().kind = contract.transient_local || lockstep
                              ? fdds::TRANSIENT_LOCAL_DURABILITY_QOS
                              : fdds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = all ? fdds::KEEP_ALL_HISTORY_QOS : fdds::KEEP_LAST_HISTORY_QOS;
  if (!all) qos.history().depth = depth;
  // Unlimited, allocated as needed: instances come and go, pictures are large.
  qos.resource_limits().max_samples = 0;
  qos.resource_limits().max_instances = 0;
  qos.resource_limits().max_samples_per_instance = 0;
  qos.resource_limits().allocated_samples = 1;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.user_data().setValue({contract.user_data.begin(), contract.user_data.end()});
  // Data sharing fails between users and containers and delays restarts by seconds.
  qos.data_sharing().off();
  if (lockstep) return;
  if (contract.exclusive_ownership) qos.ownership().kind = fdds::EXCLUSIVE_OWNERSHIP_QOS;
  if (contract.deadline.count() > 0) qos.deadline().period = duration(contract.deadline);
}

/// The keys of who joins, if they hold where it joins.
Expected<Keys> keys_of(const ParticipantOptions& options) {
  const auto now = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
  auto keys =
      load_keys(options.network.keys, options.role.empty() ? options.name : options.role, now);
  // Fast DDS would only say that it made no writer.
  if (const Scope scope = keys ? keys->permissions.scope : Scope{};
      !scope.covers(options.rig, options.domain))
    return fail("the keys hold for " + text(scope), keys->folder.string(),
                fmt::format("this is rig {} in domain {}: make others with `prehend keys`",
                            options.rig, options.domain));
  return keys;
}

constexpr std::chrono::milliseconds max_goodbye{1000};
constexpr std::size_t max_attempts = 4;  // at joining a secured lab
/// A handshake that Fast DDS 2.9 does not end. Fast DDS 3.1 goes on with it, and whoever leaves in
/// its midst takes one of a hundred places at the other side, for good (dds_log.hpp).
constexpr bool ends_by_joining_anew = PREHEND_FAST_DDS == 2;

}  // namespace

std::uint64_t instance_hash(const std::array<std::uint8_t, 16>& key) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  for (const std::uint8_t byte : key) hash = (hash ^ byte) * 0x100000001b3ULL;
  return hash;
}

std::uint64_t instance_hash(const rtps::InstanceHandle_t& handle) {
  std::array<std::uint8_t, 16> key;
  std::copy_n(static_cast<const std::uint8_t*>(handle.value), key.size(), key.begin());
  return instance_hash(key);
}

struct Participant::State {
  ParticipantOptions options;
  std::optional<Keys> keys;
  // These outlive the participant.
  std::optional<PacketGuard> packets;
  std::optional<Peers> peers;
  SerializedTransport serializer;
  fdds::DomainParticipant* participant = nullptr;
  fdds::Publisher* publisher = nullptr;
  fdds::Subscriber* subscriber = nullptr;
  std::map<std::string, fdds::Topic*, std::less<>> topics;
  std::optional<ServerWatch> servers;

  ~State() {
    servers.reset();
    if (!participant) return;
    // Otherwise its leaving may overtake its last words, which then nobody hears.
    if (publisher) publisher->wait_for_acknowledgments(duration(max_goodbye));
    serializer.close();
    participant->delete_contained_entities();
    fdds::DomainParticipantFactory::get_instance()->delete_participant(participant);
  }

  /// What stands between Fast DDS and the wire, and hears who is there.
  void guard(fdds::DomainParticipantQos& qos) {
    PacketGuard::Hear hear;
    if constexpr (hides_secured_peers)
      hear = [this](const Announcement& said) { peers->hear(said); };
    const bool paces =
        qos.wire_protocol().builtin.discovery_config.discoveryProtocol == DiscoveryProtocol::SIMPLE;
    packets.emplace(!options.serves.empty(), keys.has_value(), paces, std::move(hear));
    peers.emplace(options.listener, keys ? std::optional(keys->authority) : std::nullopt, *packets);
    // Who listens to the whole domain is a recorder: pictures that come while it has no processor
    // wait in the socket (as far as net.core.rmem_max allows), for on best effort topics nothing
    // else holds them.
    if (options.listener)
      for (auto& transport : qos.transport().user_transports)
        if (auto* socket = dynamic_cast<transport::SocketTransportDescriptor*>(transport.get()))
          socket->receiveBufferSize = 1 << 24;
    // Over TCP Fast DDS does not tell who sent a packet; there TLS decides who connects.
    for (auto& transport : qos.transport().user_transports)
      if (dynamic_cast<transport::UDPv4TransportDescriptor*>(transport.get()))
        transport = guarded(transport, *packets);
    for (auto& transport : qos.transport().user_transports)
      transport = serialized(transport, serializer);
    for (const auto& locator : servers_of(qos))
      packets->add_server(prefix_of(server_prefix(static_cast<std::uint16_t>(locator.port))),
                          ip_of(locator));
  }

  Expected<void> enter_rig() {
    fdds::PublisherQos publisher_qos = fdds::PUBLISHER_QOS_DEFAULT;
    fdds::SubscriberQos subscriber_qos = fdds::SUBSCRIBER_QOS_DEFAULT;
    if (!options.rig.empty()) {
      publisher_qos.partition().push_back(options.rig.c_str());
      subscriber_qos.partition().push_back(options.rig.c_str());
    }
    publisher = participant->create_publisher(publisher_qos);
    subscriber = participant->create_subscriber(subscriber_qos);
    if (!publisher || !subscriber) return fail("cannot join the rig", options.rig);
    return {};
  }

  /// Told of a discovery server's address, new or known.
  void server_is_at(const Address& address) {
    fdds::DomainParticipantQos qos = participant->get_qos();
    if (!add_place(qos, address)) return;
    log::info("the discovery server of port {} is at {} now", address.port,
              fmt::join(address.ip, "."));
    packets->add_server(prefix_of(server_prefix(address.port)), address.ip);
    participant->set_qos(qos);
  }

  Expected<fdds::Topic*> topic(std::string_view name, fdds::TypeSupport& type) {
    if (const auto found = topics.find(name); found != topics.end()) return found->second;
    // Several raw topics may have one type.
    if (participant->find_type(type.get_type_name()).empty()) {
      describe_nothing(*type.get());
      if (!succeeded(type.register_type(participant)))
        return fail("type of the topic cannot be registered", std::string(name));
    }
    fdds::Topic* made =
        participant->create_topic(std::string(name), type.get_type_name(), fdds::TOPIC_QOS_DEFAULT);
    if (!made)
      return fail("topic cannot be created", std::string(name), "was it made with another type?");
    topics.emplace(std::string(name), made);
    return made;
  }
};

namespace {

/// Whoever measures or moves something does so in one rig. Partitions are patterns: «*» would lead
/// the robots of all.
Expected<void> stays_in_one_rig(const ParticipantOptions& options) {
  if (options.rig.find_first_of("*?[") == std::string::npos) return {};
  const std::string& name = options.role.empty() ? options.name : options.role;
  for (const auto& [role, its_name] : role_names)
    if (its_name == name && std::ranges::any_of(topic_table, [each = role](const TopicInfo& topic) {
          return topic.content == Content::data && may_write(each, topic);
        }))
      return wrong_use("names more than one rig", "lab.rig = " + options.rig,
                       "a " + name + " takes part in one: give its name");
  return {};
}

}  // namespace

Participant::Participant(std::unique_ptr<State> state) : state_(std::move(state)) {}
Participant::Participant(Participant&&) noexcept = default;
Participant& Participant::operator=(Participant&&) noexcept = default;
Participant::~Participant() = default;

Expected<Participant> Participant::create(const ParticipantOptions& options) {
  // Who does not answer a second time either refuses us without saying so.
  std::set<rtps::GUID_t> silent;
  while (true) {
    auto made = join(options);
    if (!made || !made->keys()) return made;
    const rtps::GUID_t& own = made->state_->participant->guid();
    const auto undecided = made->state_->peers->wait_until_decided(own);
    if (!undecided) return made;
    if (!ends_by_joining_anew) {
      log::info("the handshake with {} has not ended yet", undecided->name);
      return made;
    }
    if (silent.size() == max_attempts || !silent.insert(undecided->guid).second) {
      log::warning("{} neither lets this process in nor refuses it", undecided->name);
      return made;
    }
    log::info("{} does not end its handshake: joining anew", undecided->name);
  }
}

Expected<Participant> Participant::join(const ParticipantOptions& options) {
  if (options.domain < 0 || options.domain > 232)
    return fail("domain must lie in 0 to 232", "lab.domain");
  static const bool first = (find_over_the_network_within_process(), true);
  static_cast<void>(first);
  auto state = std::make_unique<State>();
  state->options = options;
  Network network = options.network;
  if (!network.keys.empty()) {
    auto keys = keys_of(options);
    if (!keys) return tl::unexpected(keys.error());
    network.keys = keys->folder;
    state->keys.emplace(std::move(*keys));
  }
  if (auto one = stays_in_one_rig(options); !one) return tl::unexpected(one.error());
  auto qos = participant_qos(network, {options.listener != nullptr, options.serves});
  if (!qos) return tl::unexpected(qos.error());
  qos->name(options.name);
  const std::string announced = own_user_data(options.role.empty() ? options.name : options.role);
  qos->user_data().setValue({announced.begin(), announced.end()});
  if (state->keys) {
    secure(*qos, *state->keys);
    if (PREHEND_FAST_DDS == 2 && !handshakes_pause_for_removals())
      log::warning("this release of Fast DDS may lock itself up when others leave");
  }
  state->guard(*qos);
  auto* factory = fdds::DomainParticipantFactory::get_instance();
  state->participant =
      factory->create_participant(options.domain, *qos, &*state->peers, fdds::StatusMask::none());
  if (!state->participant)
    return state->keys
               ? fail("cannot join the secured lab", state->keys->folder.string(),
                      "what Fast DDS says of it stands above; are the keys meant for this lab?")
               : fail("cannot join the domain", "dds",
                      "is a network interface up, at least loopback?");
  if (network.profile == "server")
    state->servers.emplace(
        network.servers, [at = state.get()](const Address& address) { at->server_is_at(address); });
  state->packets->add_own(prefix_of(state->participant->guid().guidPrefix));
  if (state->keys)
    if (const auto effective = confirm(*state->participant, *state->keys); !effective)
      return tl::unexpected(effective.error());
  if (auto entered = state->enter_rig(); !entered) return tl::unexpected(entered.error());
  return Participant(std::move(state));
}

const Keys* Participant::keys() const {
  return state_->keys ? &*state_->keys : nullptr;
}

std::map<std::string, std::uint64_t> Participant::refused() const {
  return state_->peers->refused();
}

std::map<GuidPrefix, Peers::Presented> Participant::present() const {
  return state_->peers->present();
}

std::optional<Role> Participant::role_of(const GuidPrefix& whose) const {
  return state_->peers->role_of(whose);
}

GuidPrefix Participant::identity() const {
  return prefix_of(state_->participant->guid().guidPrefix);
}

Expected<void> Participant::confirm_listed(std::string_view topic) {
  if (!find_topic(topic)) return fail("is not in the table of topics", std::string(topic));
  return {};
}

fdds::Subscriber* Participant::subscriber() {
  return state_->subscriber;
}

Expected<fdds::DataWriter*> Participant::make_writer(std::string_view topic,
                                                     const TopicQos& contract,
                                                     fdds::TypeSupport type, bool raw) {
  const auto handle = state_->topic(topic, type);
  if (!handle) return tl::unexpected(handle.error());
  fdds::DataWriterQos qos = state_->publisher->get_default_datawriter_qos();
  apply(qos, contract, contract.writer_depth, state_->options.lockstep);
  if (contract.lifespan.count() > 0 && !state_->options.lockstep)
    qos.lifespan().duration = duration(contract.lifespan);
  qos.writer_data_lifecycle().autodispose_unregistered_instances = !raw;
  // What is kept takes what it needs: otherwise every buffer is as large as the largest
  // message. (The end of an instance without its key, as raw topics have it, needs such a one.)
  if (!raw && (contract.writer_depth == 0 || contract.transient_local))
    qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  // With the default of 3 s a lost single sample is noticed very late.
  heartbeat_period(qos.reliable_writer_qos().times) = duration(std::chrono::milliseconds(100));
  // A writer that is busy fails the next one after so long. Live, who moves a hand does not wait
  // for it; in lockstep all wait for each other, and what is not sent is awaited for ever.
  qos.reliability().max_blocking_time =
      duration(std::chrono::milliseconds(state_->options.lockstep ? 10'000 : 100));
  fdds::DataWriter* writer = state_->publisher->create_datawriter(*handle, qos);
  if (!writer)
    return fail("writer cannot be created", std::string(topic),
                state_->keys ? "do the keys of this process permit it? prehend keys show" : "");
  return writer;
}

Expected<fdds::DataReader*> Participant::make_reader(std::string_view topic,
                                                     const TopicQos& contract,
                                                     fdds::TypeSupport type,
                                                     fdds::DataReaderListener* listener, bool raw,
                                                     bool ask_for_keys) {
  const auto handle = state_->topic(topic, type);
  if (!handle) return tl::unexpected(handle.error());
  fdds::DataReaderQos qos = state_->subscriber->get_default_datareader_qos();
  apply(qos, contract, contract.reader_depth, state_->options.lockstep);
  fdds::StatusMask mask = fdds::StatusMask::data_available();
  if (raw) mask << fdds::StatusMask::subscription_matched();
  if (ask_for_keys) qos.expects_inline_qos(true);
  fdds::DataReader* reader = state_->subscriber->create_datareader(*handle, qos, listener, mask);
  if (!reader)
    return fail("reader cannot be created", std::string(topic),
                state_->keys ? "do the keys of this process permit it? prehend keys show" : "");
  return reader;
}

}  // namespace prehend::dds
