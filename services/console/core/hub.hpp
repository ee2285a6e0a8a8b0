#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "services/console/core/playback.hpp"
#include "services/console/core/protocol.hpp"
#include "services/console/core/story.hpp"

namespace prehend::console {

/// What goes to a client next, in one message of the WebSocket.
struct Frame {
  bool binary = false;
  std::string head;  // the client's own bytes
  Payload payload;   // behind them; may be nothing
};

/// The server's side of the protocol for all clients: bytes in, frames out. A client that is slower
/// than the lab gets the newest of what it watches, and is told how much it missed; it takes
/// neither memory without bounds nor anything from the others. Pure.
class Hub {
 public:
  struct Channel {
    ChannelInfo info;
    /// Each message counts. Else of each key the newest one alone does.
    bool queued = false;
    /// Not empty: messages are parts of a list that stands between these, and all that a client
    /// has not got yet goes as one.
    std::string opening, closing;
  };
  struct Options {
    /// What clients are told of this server; the session tells them whether it is still the same.
    std::string name = "prehend", session;
    std::vector<Channel> channels;        // numbered by their place
    std::vector<Parameter> parameters;    // that clients may read
    std::optional<Span> recording;        // that clients may lead
    std::vector<ServiceInfo> services;    // numbered by their place
    std::size_t max_queued = 256;         // messages of a queued channel, kept and on their way
    std::size_t max_control = 64;         // answers that a client has not taken; more: it is let go
    std::size_t max_subscriptions = 256;  // of a client
    std::size_t max_calls = 8;            // of a client that wait for their answer
  };
  using Client = std::uint64_t;
  struct Call {
    Client client = 0;
    ServiceCall asked;
  };

  explicit Hub(Options options);

  /// orders: it may call the services, which others are not even told of.
  Client connect(bool orders = false);
  void disconnect(Client client);
  void hear(Client client, std::string_view text);
  /// Bytes, where it does not speak in texts: how a recording is to be played, or a service's call.
  void hear_bytes(Client client, std::string_view bytes);
  /// What has been asked for since.
  std::vector<PlaybackRequest> take_requests();
  /// Each is to be answered once, which its client may not live to see.
  std::vector<Call> take_calls();
  void answer(const Call& call, const Expected<std::string>& document);

  /// To all who watch the channel, now or later.
  void publish(std::uint32_t channel, const std::string& key, std::int64_t stamp_ns,
               Payload payload);
  /// Later ones are not told of this key any more.
  void forget(std::uint32_t channel, const std::string& key);
  /// What was told is of another time: nobody is told it any more, whether he waits for it or not.
  void forget_all();
  /// To those who have asked; to others, as older viewers, such a message is an error.
  void tell_playback(const PlaybackState& state);
  void set_graph(std::vector<TopicEnds> graph);
  /// Tells who has missed something since the last call. Once a second will do.
  void tell_losses();

  /// Nothing: it has all.
  std::optional<Frame> next(Client client);
  /// It does not take what it asked for, so it is to be let go.
  bool overflowed(Client client) const;

  std::size_t clients() const { return clients_.size(); }
  /// Does anybody watch it?
  bool watched(std::uint32_t channel) const;
  /// Messages that those who are here have missed.
  std::uint64_t dropped() const;

 private:
  struct Watching {
    std::uint32_t subscription = 0;
    Story::Reader reader;
    std::uint64_t told = 0;  // of what it missed
  };
  struct State {
    std::deque<Frame> control;
    bool overflowed = false, graph = false, leads = false, orders = false;
    std::size_t calls = 0;                       // that wait for their answer
    std::map<std::uint32_t, Watching> watching;  // by channel
    std::uint32_t turn = 0;                      // the channel that was served last
  };

  void say(State& client, std::string text, bool binary = false);
  void take_call(Client id, State& client, ServiceCall asked);
  void obey(State& client, const Subscribe& request);
  void obey(State& client, const Unsubscribe& request);
  void obey(State& client, const GetParameters& request);
  void obey(State& client, const WatchGraph& request);
  void obey(State& client, const Refused& request);
  std::optional<Story::Part> next(std::uint32_t channel, Watching& watching);

  Options options_;
  std::vector<Story> stories_;  // by channel
  std::vector<TopicEnds> graph_;
  std::vector<PlaybackRequest> requests_;
  std::vector<Call> calls_;
  std::map<Client, State> clients_;
  Client next_client_ = 1;
};

}  // namespace prehend::console
