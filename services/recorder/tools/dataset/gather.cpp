#include "services/recorder/tools/dataset/gather.hpp"

#include <algorithm>
#include <map>

#include "common/base/log.hpp"
#include "common/base/printable.hpp"
#include "common/base/progress.hpp"
#include "services/recorder/core/dataset/hands.hpp"
#include "services/recorder/core/dataset/split.hpp"
#include "services/recorder/tools/dataset/columns_file.hpp"
#include "services/recorder/tools/dataset/message.hpp"
#include "services/recorder/tools/dataset/read_log.hpp"
#include "services/recorder/tools/dataset/read_mapped.hpp"

namespace prehend::recorder::dataset {
namespace {

class Gatherer {
 public:
  explicit Gatherer(const DatasetOptions& options) : options_(options) {}

  Expected<Gathered> gather() {
    const auto size = picture_size(options_);
    const auto files = recordings_of(options_.sources);
    if (!files) return tl::unexpected(files.error());
    gathered_.dataset.rate = options_.rate;
    if (auto asked = read_options(); !asked) return tl::unexpected(asked.error());
    Progress progress("reading recordings");
    for (std::size_t i = 0; i < files->size(); ++i) {
      if (auto read = add((*files)[i]); !read) {
        if (files->size() == 1 || read.error().exit == exit_wrong_use)
          return tl::unexpected(read.error());
        gathered_.passed_by.push_back(read.error());
      }
      progress.show(i + 1, files->size());
    }
    Dataset& dataset = gathered_.dataset;
    if (dataset.episodes.empty())
      return fail("no episode in any of these recordings", options_.sources.front(),
                  gathered_.passed_by.empty() ? "" : gathered_.passed_by.front().message(),
                  exit_no);
    std::vector<Rows*> rows;
    for (RecordedEpisode& each : dataset.episodes) rows.push_back(&each.rows);
    gathered_.left_out = keep_common(rows);
    std::erase_if(dataset.cameras, [&](const auto& camera) {
      return !rows.front()->pictures.contains(camera.first);
    });
    if (auto done = split(); !done) return tl::unexpected(done.error());
    dataset.sized = size && *size;
    if (dataset.sized)
      for (auto& [name, camera] : dataset.cameras) camera = {(*size)->first, (*size)->second};
    return std::move(gathered_);
  }

 private:
  Expected<void> read_options() {
    auto given = given_times(options_);
    if (!given) return tl::unexpected(given.error());
    given_ = std::move(*given);
    if (!options_.split.empty()) {
      auto shares = parse_split(options_.split);
      if (!shares) return tl::unexpected(shares.error());
      shares_ = std::move(*shares);
    }
    if (!options_.hands.empty()) hand_names_ = options_.hands;
    if (options_.columns.empty()) return {};
    auto columns = load_columns(options_.columns);
    if (!columns) return tl::unexpected(columns.error());
    columns_ = std::move(*columns);
    gathered_.dataset.hand = columns_->robot.empty() ? "unknown" : columns_->robot;
    return {};
  }

  RowOptions row_options() const {
    return {.rate = options_.rate,
            .turns = options_.turns == "columns" ? Turns::columns : Turns::quaternion};
  }

  Expected<void> add(const std::filesystem::path& file) {
    if (columns_) return add_mapped(file);
    std::vector<ReadLog> read;
    for (const std::string& name : hand_names_) {
      auto of_hand = read_log(file, name);
      if (!of_hand) return tl::unexpected(of_hand.error());
      if (read.empty())
        for (Error& error : of_hand->damage) gathered_.passed_by.push_back(std::move(error));
      read.push_back(std::move(*of_hand));
    }
    if (auto same = same_hands(read, file); !same) return same;
    std::vector<HandLog> hands;
    for (std::size_t i = 0; i < read.size(); ++i)
      hands.push_back({as_name(hand_names_[i]), &read[i].log, hand_of(read[i].log.model)});
    const RecordingLog& log = read.front().log;
    std::vector<Episode> episodes =
        given_.empty() ? find_episodes(hands)
                       : given_episodes(given_, read.front().start, "lead the hand");
    for (Episode& episode : episodes)
      if (!episode.object.empty()) episode.object = as_name(episode.object);
    return keep_all(
        file, std::move(episodes),
        [&](const Episode& episode) { return make_rows(hands, episode, row_options()); },
        [&](RecordedEpisode& kept) {
          kept.simulated = log.simulated;
          keep_cameras(log.cameras, kept);
        });
  }

  Expected<void> add_mapped(const std::filesystem::path& file) {
    auto read = read_mapped(file, *columns_);
    if (!read) return tl::unexpected(read.error());
    for (Error& error : read->damage) gathered_.passed_by.push_back(std::move(error));
    const MappedLog& log = read->log;
    if (auto same = same_columns(log, file); !same) return same;
    const EpisodeRule rule{given_, seconds(columns_->gap),
                           columns_->task.empty() ? file.stem().string() : columns_->task};
    return keep_all(
        file, find_episodes(log, rule, read->start),
        [&](const Episode& episode) { return make_rows(log, episode, row_options()); },
        [&](RecordedEpisode& kept) {
          keep_cameras(log.cameras, kept);
          for (const PicturesOf& pictures : columns_->pictures)
            kept.picture_sources[pictures.name] = {pictures.topic, pictures.field};
        });
  }

  /// Vectors of other columns cannot stand in one set.
  Expected<void> same_columns(const MappedLog& log, const std::filesystem::path& file) {
    std::vector<std::string> all;
    for (const Track& track : log.tracks)
      if (track.role != Role::observation)
        all.insert(all.end(), track.columns.begin(), track.columns.end());
    if (mapped_columns_.empty()) mapped_columns_ = all;
    if (mapped_columns_ == all) return {};
    return wrong_use("its states or actions have other elements than those before", file.string(),
                     "name those that all have: only = [...] in " + options_.columns);
  }

  /// Rows of each episode; those that have none are passed by.
  template <class Make, class Complete>
  Expected<void> keep_all(const std::filesystem::path& file, std::vector<Episode> episodes,
                          const Make& make, const Complete& complete) {
    std::size_t made = 0;
    for (Episode& episode : episodes) {
      auto rows = make(episode);
      if (!options_.task.empty()) episode.task = options_.task;
      if (!rows) {
        gathered_.passed_by.push_back(
            {rows.error().what, file.string(), rows.error().hint, exit_no});
        continue;
      }
      RecordedEpisode kept{file, std::move(episode), std::move(*rows), {}, false, {}, {}};
      complete(kept);
      gathered_.dataset.episodes.push_back(std::move(kept));
      ++made;
    }
    if (made > 0) return {};
    const Error reason = gathered_.passed_by.empty()
                             ? Error{"has no episode", file.string(), "", exit_no}
                             : gathered_.passed_by.back();
    if (!gathered_.passed_by.empty()) gathered_.passed_by.pop_back();
    return tl::unexpected(reason);
  }

  const model::HandModel* hand_of(const std::string& model) const {
    const auto found = hands_.find(model);
    return found == hands_.end() ? nullptr : &found->second;
  }

  Expected<void> same_hands(const std::vector<ReadLog>& read, const std::filesystem::path& file) {
    std::string models;
    for (const ReadLog& each : read) models += (models.empty() ? "" : "+") + each.log.model;
    Dataset& dataset = gathered_.dataset;
    if (!dataset.hand.empty() && dataset.hand != models)
      return wrong_use("its hand is " + models + ", that of the others " + dataset.hand,
                       file.string(), "export them apart");
    if (!dataset.hand.empty()) return {};
    dataset.hand = models;
    for (const ReadLog& each : read) {
      const std::string& model = each.log.model;
      const auto folder = model::named_hand(model);
      if (auto hand = folder ? model::HandModel::load(*folder) : tl::unexpected(folder.error()))
        hands_.insert_or_assign(model, std::move(*hand));
      else
        log::warning("{}: its hand {} is not known here: fingertips are left out", file.string(),
                     printable(model));
    }
    return {};
  }

  void keep_cameras(const std::map<std::string, Camera>& cameras, RecordedEpisode& kept) {
    for (const auto& [name, camera] : cameras) {
      kept.picture_times[name] = camera.times;
      gathered_.dataset.cameras.emplace(name, Size{camera.width, camera.height});
    }
  }

  /// Says to which part each episode belongs; those of one part stand together, as LeRobot wants.
  Expected<void> split() {
    if (shares_.empty()) return {};
    Dataset& dataset = gathered_.dataset;
    const auto parts = draw_split(shares_, dataset.episodes.size(), options_.split_seed);
    if (!parts) return tl::unexpected(parts.error());
    std::vector<RecordedEpisode> ordered;
    for (std::size_t part = 0; part < shares_.size(); ++part) {
      const std::string& name = shares_[part].first;
      dataset.splits.emplace_back(name, std::ranges::count(*parts, part));
      for (std::size_t i = 0; i < parts->size(); ++i) {
        if ((*parts)[i] != part) continue;
        ordered.push_back(std::move(dataset.episodes[i]));
        ordered.back().split = name;
      }
    }
    dataset.episodes = std::move(ordered);
    return {};
  }

  const DatasetOptions& options_;
  Gathered gathered_;
  std::vector<std::string> hand_names_{""};        // one that is empty: the only hand
  std::map<std::string, model::HandModel> hands_;  // by kind, those that are known
  std::optional<ColumnsFile> columns_;
  std::vector<std::pair<double, double>> given_;
  Shares shares_;
  std::vector<std::string> mapped_columns_;  // of states and actions
};

}  // namespace

bool Dataset::all_judged() const {
  return std::ranges::all_of(
      episodes, [](const RecordedEpisode& each) { return each.episode.success.has_value(); });
}

Expected<Gathered> gather(const DatasetOptions& options) {
  return Gatherer(options).gather();
}

}  // namespace prehend::recorder::dataset
