#include "services/recorder/tools/check/recorded_lab.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include "common/dds/topics.hpp"
#include "common/recording/layout/layout.hpp"
#include "common/recording/types/value.hpp"
#include "common/service/config.hpp"

namespace prehend::recorder {
namespace {

using recording::types::Value;

/// If there still is such a setting.
void add(Settings& settings, const std::string& key, const std::string& value) {
  if (std::ranges::find(service::config_keys(), key, &service::ConfigKey::name) !=
      service::config_keys().end())
    settings[key] = value;
}

std::string text_of(const Value& message, std::string_view field) {
  const Value* value = message.find(field);
  const auto* text = value ? std::get_if<std::string>(&value->content) : nullptr;
  return text ? *text : std::string();
}

std::optional<RecordedProcess> process_of(const Played& told,
                                          const recording::types::Library& types) {
  const auto* type = types.find(told.stream->topic.type);
  const auto message = type && told.sample.kind == dds::RawSample::Kind::data
                           ? recording::types::decode(*type, told.sample.payload)
                           : Expected<Value>(tl::unexpected(Error{}));
  const Value* settings = message ? message->find("settings") : nullptr;
  const auto* list = settings ? std::get_if<Value::List>(&settings->content) : nullptr;
  if (!list) return std::nullopt;
  RecordedProcess process{text_of(*message, "name"), {}};
  for (const Value& one : *list) add(process.settings, text_of(one, "key"), text_of(one, "value"));
  return process;
}

/// A process, from when to when something was heard of it.
struct Life {
  RecordedProcess process;
  Time begin, end;
};

}  // namespace

bool is_of_the_machine(const std::string& key) {
  static const std::set<std::string> devices{"recognition.path", "glove.file", "glove.port",
                                             "glove.wrist_port"};
  return (key.starts_with("lab.") && key != "lab.catalogue") || devices.contains(key);
}

RecordedLab recorded_lab(const recording::mcap::Reader& file) {
  RecordedLab lab;
  for (const auto& index : file.contents().metadata)
    if (index.name == recording::configuration_record)
      if (const auto record = file.metadata(index))
        for (const auto& [key, value] : record->metadata) add(lab.configuration, key, value);
  for (const auto& index : file.contents().attachments) {
    recording::mcap::Bytes buffer;
    if (const auto attachment = file.attachment(index, buffer)) {
      if (index.name == recording::scene_attachment)
        lab.scene = recording::mcap::text(attachment->data);
      if (index.name == recording::catalogue_attachment)
        lab.catalogue = recording::mcap::text(attachment->data);
    }
  }
  return lab;
}

std::vector<RecordedProcess> recorded_processes(const std::vector<Played>& played,
                                                const recording::types::Library& types) {
  std::map<dds::Guid, Life> lives;  // by instance, which is the same on both topics
  for (const Played& one : played) {
    if (one.stream->topic.name != dds::service_settings.name) continue;
    if (auto process = process_of(one, types)) {
      Life& life = lives.try_emplace(one.stream->instance, Life{{}, one.log_time, one.log_time})
                       .first->second;
      life.process = std::move(*process);
      life.end = one.log_time;
    }
  }
  for (const Played& one : played)
    if (one.stream->topic.name == dds::service_status.name)
      if (const auto life = lives.find(one.stream->instance); life != lives.end())
        life->second.end = std::max(life->second.end, one.log_time);
  std::vector<Life> in_order;
  for (auto& [instance, life] : lives) in_order.push_back(std::move(life));
  std::ranges::stable_sort(in_order, {}, &Life::begin);
  std::vector<Life> places;
  for (Life& life : in_order) {
    const auto place = std::ranges::find_if(places, [&](const Life& before) {
      return before.process.service == life.process.service && before.end < life.begin;
    });
    if (place == places.end())
      places.push_back(std::move(life));
    else
      *place = std::move(life);
  }
  std::vector<RecordedProcess> processes;
  for (Life& life : places) processes.push_back(std::move(life.process));
  return processes;
}

}  // namespace prehend::recorder
