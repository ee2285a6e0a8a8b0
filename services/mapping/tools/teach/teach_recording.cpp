#include "services/mapping/tools/teach/teach_recording.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/dds/raw.hpp"
#include "common/dds/topics.hpp"
#include "common/recording/mcap/reader.hpp"
#include "services/mapping/service/messages.hpp"

namespace prehend::mapping {

namespace {

struct Label {
  Time at;
  std::string text;
};

/// What a recording says of hands and of what they show.
struct Session {
  std::deque<std::pair<Time, Features>> samples;
  std::vector<Label> labels;
};

template <class P>
std::optional<typename P::type> message(const dds::Topic<P>& topic,
                                        const recording::mcap::ReadMessage& read) {
  if (read.channel->topic != topic.name) return std::nullopt;
  dds::RawSample sample;
  sample.payload.assign(read.message.data.begin(), read.message.data.end());
  typename P::type decoded;
  if (!dds::decode(topic, sample, decoded)) return std::nullopt;
  return decoded;
}

Expected<Session> read_session(const std::filesystem::path& file) {
  auto reader = recording::mcap::Reader::open(file);
  if (!reader) return tl::unexpected(reader.error());
  Session session;
  recording::mcap::MessageCursor cursor =
      reader->messages({.wanted = [](const recording::mcap::Channel& channel) {
        return channel.topic == dds::hand_posture.name ||
               channel.topic == dds::operator_command.name;
      }});
  while (true) {
    const auto read = cursor.next();
    if (!read) continue;  // a damaged stretch: what can be read counts
    if (!*read) break;
    if (const auto posture = message(dds::hand_posture, **read)) {
      const auto hand = posture_from_message(*posture);
      if (!hand) continue;
      if (const auto seen = features(hand->fingertips, hand->hand_scale))
        session.samples.emplace_back(hand->stamp, *seen);
    } else if (const auto order = message(dds::operator_command, **read)) {
      if (order->action() == v1::ACTION_TEACH)
        session.labels.push_back({from_ns(order->stamp_ns()), order->argument().to_string()});
    }
  }
  if (session.samples.empty()) return fail("holds no usable hand/posture", file.string());
  std::stable_sort(session.samples.begin(), session.samples.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  return session;
}

}  // namespace

std::string label_of(const learning::TrainingPair& pair) {
  return pair.object.empty() ? pair.posture : pair.posture + " on " + pair.object;
}

Expected<std::vector<Shown>> shown_in(const std::filesystem::path& recording,
                                      const std::multimap<std::string, double>& labels,
                                      const std::vector<learning::TrainingPair>& curriculum,
                                      const TeachOptions& options) {
  auto session = read_session(recording);
  if (!session) return tl::unexpected(session.error());
  for (const auto& [text, at] : labels)
    session->labels.push_back({session->samples.front().first + seconds(at), text});
  if (session->labels.empty())
    return fail("nobody said what was shown", recording.string(), "give --label POSTURE@SECONDS");

  // The session took what was still for so long, which a late frame may shorten.
  const Duration window_length = options.still_for * 9 / 10;
  std::map<std::string, std::pair<std::size_t, Shown>> found;  // by label: order, posture
  for (const Label& label : session->labels) {
    const auto meant = std::find_if(curriculum.begin(), curriculum.end(),
                                    [&](const auto& pair) { return label_of(pair) == label.text; });
    if (meant == curriculum.end())
      return fail(fmt::format("the scheme knows no «{}»", label.text), recording.string());
    std::deque<std::pair<Time, Features>> window;
    for (const auto& sample : session->samples)
      if (sample.first <= label.at && sample.first >= label.at - window_length)
        window.push_back(sample);
    if (static_cast<int>(window.size()) < options.min_samples)
      return fail(fmt::format("too few postures before «{}»", label.text), recording.string());
    const Stillness still = stillness(window);
    if (still.wobble > options.still_within)
      return fail(
          fmt::format("the hand moved {:.0f} mm before «{}»", 1000 * still.wobble, label.text),
          recording.string(), "label where it is still");
    Shown shown{*meant, still.wobble, 0, {}, 1 - still.wobble / options.still_within};
    shown.pair.features = still.mean;
    shown.pair.source = "recording";
    found[label.text] = {static_cast<std::size_t>(meant - curriculum.begin()), std::move(shown)};
  }
  std::vector<std::pair<std::size_t, Shown>> ordered;
  for (auto& [text, entry] : found) ordered.push_back(std::move(entry));
  std::sort(ordered.begin(), ordered.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Shown> shown;
  for (auto& [place, posture] : ordered) shown.push_back(std::move(posture));
  return shown;
}

}  // namespace prehend::mapping
