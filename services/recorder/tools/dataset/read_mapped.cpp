#include "services/recorder/tools/dataset/read_mapped.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/base/printable.hpp"
#include "services/recorder/tools/dataset/picture_file.hpp"
#include "services/recorder/tools/dataset/pictures.hpp"
#include "services/recorder/tools/dataset/recorded_messages.hpp"

namespace prehend::recorder::dataset {
namespace {

using recording::types::Value;

tl::unexpected<Error> wrong(const FieldPath& field, const std::string& what) {
  return fail(fmt::format("field «{}» {}", field.text(), what));
}

/// Makes a track of one field.
class TrackTaker {
 public:
  explicit TrackTaker(const ColumnsOf& columns)
      : columns_(columns), track_{columns.name, columns.role, {}, {}, {}} {}

  const std::string& topic() const { return columns_.topic; }
  const ColumnsOf& columns() const { return columns_; }
  Track& track() { return track_; }

  Expected<void> take(const Value& message, Time time) {
    const Value* value = columns_.field.in(message);
    if (!value) return wrong(columns_.field, "is not there");
    if (!is_pose_) is_pose_ = !columns_.names && columns_.only.empty() && has_parts_of_pose(*value);
    if (!*is_pose_) return take_numbers(message, *value, time);
    const auto pose = as_pose(*value);
    if (!pose) return wrong(columns_.field, "is no sound pose");
    if (track_.columns.empty() && !columns_.field.text().empty())
      track_.columns = {columns_.field.text()};
    track_.poses.add(time, *pose);
    return {};
  }

 private:
  Expected<void> take_numbers(const Value& message, const Value& value, Time time) {
    auto all = flat(value);
    if (!all) return wrong(columns_.field, "is not of finite numbers");
    if (columns_.names) {
      const Value* list = columns_.names->in(message);
      auto names = list ? texts(*list) : std::nullopt;
      if (!names || names->size() != all->numbers.size())
        return wrong(*columns_.names, "does not name them all");
      all->names = std::move(*names);
    }
    if (elements_.empty()) choose(*all);
    Eigen::VectorXd numbers(static_cast<Eigen::Index>(elements_.size()));
    if (!columns_.names && columns_.only.empty() && elements_ != all->names)
      return wrong(columns_.field, "is of another size or shape than before");
    for (std::size_t i = 0; i < elements_.size(); ++i) {
      const auto at = std::ranges::find(all->names, elements_[i]);
      if (at == all->names.end())
        return wrong(columns_.field, fmt::format("has no element «{}»", elements_[i]));
      numbers[static_cast<Eigen::Index>(i)] =
          all->numbers[static_cast<std::size_t>(at - all->names.begin())];
    }
    track_.numbers.add(time, std::move(numbers));
    return {};
  }

  /// The first message decides which elements there are.
  void choose(const Flat& all) {
    elements_ = columns_.only.empty() ? all.names : columns_.only;
    track_.columns.clear();
    for (const std::string& element : elements_) {
      const std::string& field = columns_.field.text();
      track_.columns.push_back(columns_.names || field.empty() ? element
                               : element.empty()               ? field
                                                               : field + "." + element);
    }
  }

  const ColumnsOf& columns_;
  Track track_;
  std::optional<bool> is_pose_;
  std::vector<std::string> elements_;
};

class MappedTaker {
 public:
  explicit MappedTaker(const ColumnsFile& columns) : columns_(columns) {
    for (const ColumnsOf& each : columns.columns) tracks_.emplace_back(each);
  }

  bool wants(const std::string& topic) const {
    return std::ranges::any_of(tracks_, [&](const auto& t) { return t.topic() == topic; }) ||
           std::ranges::any_of(columns_.pictures,
                               [&](const auto& p) { return p.topic == topic; }) ||
           (columns_.marks && columns_.marks->topic == topic);
  }

  Expected<void> take(const std::string& topic, const Value& message, Time time) {
    Expected<void> done;
    const auto note = [&](Expected<void> one) {
      if (done && !one) done = std::move(one);
    };
    for (TrackTaker& track : tracks_)
      if (track.topic() == topic) note(track.take(message, time));
    for (const PicturesOf& pictures : columns_.pictures)
      if (pictures.topic == topic) note(picture(pictures, message, time));
    if (columns_.marks && columns_.marks->topic == topic) mark(message, time);
    return done;
  }

  /// Fails where a mapped field was never told.
  Expected<MappedLog> finish() {
    const auto silent = [](const std::string& topic, const FieldPath& field) {
      return fail(fmt::format("has no message of {} whose field «{}» can be used", printable(topic),
                              field.text()));
    };
    for (TrackTaker& each : tracks_) {
      if (each.track().times().empty()) return silent(each.topic(), each.columns().field);
      log_.tracks.push_back(std::move(each.track()));
    }
    for (const PicturesOf& each : columns_.pictures)
      if (!log_.cameras.contains(each.name)) return silent(each.topic, each.field);
    for (const Role role : {Role::state, Role::action}) tell_apart(role);
    return std::move(log_);
  }

 private:
  Expected<void> picture(const PicturesOf& pictures, const Value& message, Time time) {
    const Value* value = pictures.field.in(message);
    const auto bytes = value ? bytes_of(*value) : std::nullopt;
    if (!bytes || bytes->empty()) return wrong(pictures.field, "is no picture");
    const auto known = log_.cameras.find(pictures.name);
    if (known == log_.cameras.end()) {
      const auto file = picture_file(message, pictures.field);
      if (!file) return wrong(pictures.field, file.error().what);
      const auto first = decoder_.decode(*file);
      if (!first) return wrong(pictures.field, "is neither jpeg nor png, nor a raw picture");
      log_.cameras[pictures.name] = {{time}, first->size.width, first->size.height};
    } else if (time > known->second.times.back()) {
      known->second.times.push_back(time);
    }
    return {};
  }

  void mark(const Value& message, Time time) {
    const MarksOf& marks = *columns_.marks;
    Mark made{time};
    if (marks.field) {
      const Value* value = marks.field->in(message);
      made.begins = value && is_yes(*value);
      made.ends = !made.begins;
    }
    const Value* success = marks.success ? marks.success->in(message) : nullptr;
    if (success) made.success = is_yes(*success);
    if (log_.marks.empty() || time >= log_.marks.back().time) log_.marks.push_back(made);
  }

  /// Columns of one vector bear names of their own: with their fields, or else their topics.
  void tell_apart(Role role) {
    for (const bool by_topic : {false, true}) {
      std::set<std::string> seen;
      bool twice = false;
      for (const Track& track : log_.tracks)
        if (track.role == role)
          for (const std::string& column : track.columns) twice |= !seen.insert(column).second;
      if (!twice) return;
      for (std::size_t i = 0; i < log_.tracks.size(); ++i)
        if (log_.tracks[i].role == role)
          for (std::string& column : log_.tracks[i].columns)
            column = (by_topic ? columns_.columns[i].topic : columns_.columns[i].field.text()) +
                     "." + column;
    }
  }

  const ColumnsFile& columns_;
  std::vector<TrackTaker> tracks_;
  PictureDecoder decoder_;
  MappedLog log_;
};

}  // namespace

Expected<ReadMapped> read_mapped(const std::filesystem::path& file, const ColumnsFile& columns) {
  auto reader = open_recording(file);
  if (!reader) return tl::unexpected(reader.error());
  RecordedMessages messages(*reader);
  MappedTaker taker(columns);
  messages.read([&](const std::string& topic) { return taker.wants(topic); },
                [&](const std::string& topic, const Value& message, Time time) {
                  return taker.take(topic, message, time);
                });
  ReadMapped read{{}, first_time(*reader), reader->contents().damage};
  for (Error& error : messages.damage()) read.damage.push_back(std::move(error));
  auto log = taker.finish();
  if (!log)
    return fail(log.error().what, file.string(),
                read.damage.empty() ? "prehend recording info FILE lists its topics"
                                    : read.damage.back().hint,
                exit_no);
  read.log = std::move(*log);
  return read;
}

}  // namespace prehend::recorder::dataset
