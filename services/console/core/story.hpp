#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace prehend::console {

/// Bytes that all clients share.
using Payload = std::shared_ptr<const std::string>;

/// What a channel has told: the newest message of each key, in the order in which they came. It
/// stands here once for all, and each client reads it from where it is: so a message costs the same
/// for one client and for fifty, and a slow client costs nothing. Pure.
class Story {
 public:
  /// Where a client is.
  struct Reader {
    std::uint64_t begun = 0;   // number of the last message when it came
    std::uint64_t read = 0;    // number of the last one that it has got
    std::uint64_t missed = 0;  // newer ones of their keys came before it took them
  };
  struct Part {
    std::int64_t stamp_ns = 0;
    Payload payload;
  };

  /// At most so many messages are kept, and as many of what has ended.
  explicit Story(std::size_t max_kept, std::size_t max_ended)
      : max_kept_(max_kept), max_ended_(max_ended) {}

  void put(const std::string& key, std::int64_t stamp_ns, Payload payload);
  /// The newest of this key was its last: who is here still gets it, who comes later does not.
  void end(const std::string& key);
  /// As if nothing had been told.
  void clear();

  /// One who is told first what is there, and then what comes.
  Reader begin() const { return {count_, 0, 0}; }
  std::optional<Part> next(Reader& reader) const;
  /// All that it has not got, with commas between, inside opening and closing; the stamp is the
  /// newest. Clients that are at the same place share the bytes.
  std::optional<Part> rest(Reader& reader, std::string_view opening, std::string_view closing);
  std::uint64_t missed(const Reader& reader) const;
  /// What it has not got yet is not for it any more.
  void skip(Reader& reader) const { reader.read = count_; }

 private:
  struct Message {
    std::string key;
    Part part;
    bool ended = false;
  };
  using Messages = std::map<std::uint64_t, Message>;  // by number
  Messages::const_iterator unread(const Reader& reader) const;
  void erase(const std::string& key);

  std::size_t max_kept_, max_ended_;
  std::uint64_t count_ = 0;  // of all that has been told
  Messages messages_;
  std::unordered_map<std::string, std::uint64_t> numbers_;  // by key
  std::deque<std::string> ended_;                           // keys
  struct {
    std::uint64_t after = 0, until = 0;
    Part part;
  } joined_;  // the last rest() that was asked for
};

}  // namespace prehend::console
