#include "services/console/core/hub.hpp"

#include <fmt/format.h>

#include <limits>
#include <utility>

namespace prehend::console {

Hub::Hub(Options options) : options_(std::move(options)) {
  // Instances are bounded where they come from.
  constexpr std::size_t all = std::numeric_limits<std::size_t>::max();
  for (Channel& channel : options_.channels) {
    channel.info.id = static_cast<std::uint32_t>(stories_.size());
    stories_.emplace_back(channel.queued ? options_.max_queued : all, options_.max_queued);
  }
  std::uint32_t service = 0;
  for (ServiceInfo& one : options_.services) one.id = service++;
}

Hub::Client Hub::connect(bool orders) {
  const Client client = next_client_++;
  State& state = clients_[client];
  state.orders = orders && !options_.services.empty();
  say(state, server_info(options_.name, options_.session, options_.recording, state.orders));
  std::vector<ChannelInfo> channels;
  for (const Channel& channel : options_.channels) channels.push_back(channel.info);
  say(state, advertisement(channels));
  if (state.orders) say(state, service_advertisement(options_.services));
  return client;
}

void Hub::disconnect(Client client) {
  clients_.erase(client);
}

void Hub::hear(Client client, std::string_view text) {
  const auto found = clients_.find(client);
  if (found == clients_.end()) return;
  std::visit([&](const auto& request) { obey(found->second, request); }, read_request(text));
}

void Hub::hear_bytes(Client client, std::string_view bytes) {
  constexpr std::size_t max_requests = 64;  // between two ticks
  const auto found = clients_.find(client);
  if (found == clients_.end()) return;
  if (auto call = read_service_call(bytes))
    return take_call(client, found->second, std::move(*call));
  if (!options_.recording || requests_.size() >= max_requests) return;
  auto request = read_playback(bytes);
  if (!request) return;
  found->second.leads = true;
  requests_.push_back(std::move(*request));
}

void Hub::take_call(Client id, State& client, ServiceCall asked) {
  const auto refuse = [&](const char* why) { say(client, service_failure(asked, why)); };
  if (!client.orders) return refuse("viewers only look: orders need the page's token");
  if (asked.service >= options_.services.size()) return refuse("there is no such service");
  if (asked.encoding != "json") return refuse("is not json");
  if (client.calls >= options_.max_calls) return refuse("too many orders wait for their answer");
  ++client.calls;
  calls_.push_back({id, std::move(asked)});
}

std::vector<Hub::Call> Hub::take_calls() {
  return std::exchange(calls_, {});
}

void Hub::answer(const Call& call, const Expected<std::string>& document) {
  const auto found = clients_.find(call.client);
  if (found == clients_.end()) return;
  --found->second.calls;
  if (document)
    say(found->second, service_response(call.asked, *document), true);
  else
    say(found->second, service_failure(call.asked, document.error().message()));
}

std::vector<PlaybackRequest> Hub::take_requests() {
  return std::exchange(requests_, {});
}

void Hub::say(State& client, std::string text, bool binary) {
  if (client.control.size() >= options_.max_control) {
    client.overflowed = true;
    return;
  }
  client.control.push_back({binary, "", std::make_shared<const std::string>(std::move(text))});
}

void Hub::obey(State& client, const Subscribe& request) {
  for (const auto& [subscription, channel] : request.all) {
    if (channel >= options_.channels.size() ||
        client.watching.size() >= options_.max_subscriptions) {
      say(client, status_message(2, fmt::format("there is no channel {}", channel), "channel"));
      continue;
    }
    client.watching[channel] = {subscription, stories_[channel].begin(), 0};
  }
}

void Hub::obey(State& client, const Unsubscribe& request) {
  for (const std::uint32_t subscription : request.subscriptions)
    std::erase_if(client.watching,
                  [&](const auto& entry) { return entry.second.subscription == subscription; });
}

void Hub::obey(State& client, const GetParameters& request) {
  say(client, parameter_values(options_.parameters, request));
}

void Hub::obey(State& client, const WatchGraph& request) {
  client.graph = request.wanted;
  if (request.wanted) say(client, graph_update({}, graph_));
}

void Hub::obey(State& client, const Refused& request) {
  if (!request.what.empty()) say(client, status_message(1, request.what, "request"));
}

void Hub::publish(std::uint32_t channel, const std::string& key, std::int64_t stamp_ns,
                  Payload payload) {
  stories_[channel].put(key, stamp_ns, std::move(payload));
}

void Hub::forget(std::uint32_t channel, const std::string& key) {
  stories_[channel].end(key);
}

void Hub::forget_all() {
  for (auto& [id, client] : clients_)
    for (auto& [channel, watching] : client.watching) stories_[channel].skip(watching.reader);
  for (Story& story : stories_) story.clear();
}

std::uint64_t Hub::dropped() const {
  std::uint64_t all = 0;
  for (const auto& [id, client] : clients_)
    for (const auto& [channel, watching] : client.watching)
      all += stories_[channel].missed(watching.reader);
  return all;
}

void Hub::tell_playback(const PlaybackState& state) {
  const std::string message = playback_message(state);
  // Who takes nothing is told the time later: that is no reason to let him go.
  for (auto& [id, client] : clients_)
    if (client.leads && (state.sought || client.control.size() < options_.max_control / 2))
      say(client, message, true);
}

void Hub::set_graph(std::vector<TopicEnds> graph) {
  const std::string update = graph_update(graph_, graph);
  graph_ = std::move(graph);
  for (auto& [id, client] : clients_)
    if (client.graph) say(client, update);
}

void Hub::tell_losses() {
  for (auto& [id, client] : clients_) {
    std::string words;
    for (auto& [channel, watching] : client.watching) {
      const std::uint64_t missed = stories_[channel].missed(watching.reader);
      if (missed == watching.told) continue;
      watching.told = missed;
      words += fmt::format("{}{} of {}", words.empty() ? "" : ", ", missed,
                           options_.channels[channel].info.topic);
    }
    // What does not fit is said a second later: it is no reason to let a client go.
    if (!words.empty() && client.control.size() < options_.max_control / 2)
      say(client, status_message(1, "too slow for all messages; missed " + words, "missed"));
  }
}

std::optional<Frame> Hub::next(Client id) {
  const auto found = clients_.find(id);
  if (found == clients_.end()) return std::nullopt;
  State& client = found->second;
  if (!client.control.empty()) {
    Frame frame = std::move(client.control.front());
    client.control.pop_front();
    return frame;
  }
  // Channels take turns, so that one that never rests does not silence the others.
  const auto serve = [&](auto from, auto to) -> std::optional<Frame> {
    for (; from != to; ++from) {
      auto part = next(from->first, from->second);
      if (!part) continue;
      client.turn = from->first;
      return Frame{true, message_head(from->second.subscription, part->stamp_ns),
                   std::move(part->payload)};
    }
    return std::nullopt;
  };
  const auto behind = client.watching.upper_bound(client.turn);
  if (auto frame = serve(behind, client.watching.end())) return frame;
  return serve(client.watching.begin(), behind);
}

std::optional<Story::Part> Hub::next(std::uint32_t channel, Watching& watching) {
  const auto& [info, queued, opening, closing] = options_.channels[channel];
  Story& story = stories_[channel];
  return opening.empty() ? story.next(watching.reader)
                         : story.rest(watching.reader, opening, closing);
}

bool Hub::overflowed(Client client) const {
  const auto found = clients_.find(client);
  return found != clients_.end() && found->second.overflowed;
}

bool Hub::watched(std::uint32_t channel) const {
  for (const auto& [id, client] : clients_)
    if (client.watching.contains(channel)) return true;
  return false;
}

}  // namespace prehend::console
