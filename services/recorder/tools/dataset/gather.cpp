#include "services/recorder/tools/dataset/gather.hpp"

#include <algorithm>

#include "common/base/log.hpp"
#include "common/base/printable.hpp"
#include "common/base/progress.hpp"
#include "services/recorder/tools/dataset/message.hpp"
#include "services/recorder/tools/dataset/read_log.hpp"

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
    dataset.sized = size && *size;
    if (dataset.sized)
      for (auto& [name, camera] : dataset.cameras) camera = {(*size)->first, (*size)->second};
    return std::move(gathered_);
  }

 private:
  Expected<void> add(const std::filesystem::path& file) {
    auto read = read_log(file, options_.hand);
    if (!read) return tl::unexpected(read.error());
    for (Error& error : read->damage) gathered_.passed_by.push_back(std::move(error));
    RecordingLog& log = read->log;
    if (auto same = same_hand(log.model, file); !same) return same;
    std::vector<Episode> episodes = find_episodes(log);
    std::size_t made = 0;
    for (Episode& episode : episodes) {
      if (!episode.object.empty()) episode.object = as_name(episode.object);
      auto rows =
          make_rows(log, episode,
                    {.rate = options_.rate,
                     .turns = options_.turns == "columns" ? Turns::columns : Turns::quaternion,
                     .hand = hand_ ? &*hand_ : nullptr});
      if (!options_.task.empty()) episode.task = options_.task;
      if (!rows) {
        gathered_.passed_by.push_back({rows.error().what, file.string(), "", exit_no});
        continue;
      }
      keep(file, log, std::move(episode), std::move(*rows));
      ++made;
    }
    if (made == 0) {
      const Error reason = gathered_.passed_by.empty()
                               ? Error{"has no episode", file.string(), "", exit_no}
                               : gathered_.passed_by.back();
      if (!gathered_.passed_by.empty()) gathered_.passed_by.pop_back();
      return tl::unexpected(reason);
    }
    return {};
  }

  Expected<void> same_hand(const std::string& model, const std::filesystem::path& file) {
    Dataset& dataset = gathered_.dataset;
    if (!dataset.hand.empty() && dataset.hand != model)
      return wrong_use("its hand is " + model + ", that of the others " + dataset.hand,
                       file.string(), "export them apart");
    if (!dataset.hand.empty()) return {};
    dataset.hand = model;
    const auto folder = model::named_hand(model);
    if (auto hand = folder ? model::HandModel::load(*folder) : tl::unexpected(folder.error()))
      hand_ = std::move(*hand);
    else
      log::warning("{}: its hand {} is not known here: fingertips are left out", file.string(),
                   printable(model));
    return {};
  }

  void keep(const std::filesystem::path& file, const RecordingLog& log, Episode episode,
            Rows rows) {
    RecordedEpisode kept{file, std::move(episode), std::move(rows), {}, log.simulated};
    for (const auto& [name, camera] : log.cameras) {
      kept.picture_times[name] = camera.times;
      gathered_.dataset.cameras.emplace(name, Size{camera.width, camera.height});
    }
    gathered_.dataset.episodes.push_back(std::move(kept));
  }

  const DatasetOptions& options_;
  Gathered gathered_;
  std::optional<model::HandModel> hand_;
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
