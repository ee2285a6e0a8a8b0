#include "services/demonstration/files/takes_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "common/base/csv_rows.hpp"
#include "common/base/file_text.hpp"
#include "common/base/printable.hpp"

namespace prehend::demonstration {

namespace {

constexpr std::array fingers{"index", "middle", "ring", "little"};
constexpr std::array hand_fingers{"thumb", "index", "middle", "ring", "little"};
constexpr std::array size_columns{"size_x_cm", "size_y_cm", "size_z_cm"};
constexpr std::array keys{"user", "object", "trial", "t_ms"};
constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
constexpr double farthest = 0.5;    // m, between fingertips of a hand
constexpr double fastest = 50;      // m/s
constexpr double latest = 1e11;     // s; a time may be counted from 1970
constexpr double largest = 2;       // m, of an object
constexpr double largest_hand = 3;  // relative to an average one
constexpr double min_span = 0.8;    // cm, thumb to finger: the median of a file in metres is less
constexpr double max_span = 30;     // cm: that of a file in millimetres is more
constexpr std::size_t max_name = 64;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view around = " \t\"";
  const auto begin = text.find_first_not_of(around);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(around) - begin + 1);
}

/// NaN where there is no number, or none within ±limit.
double number(std::string_view cell, double limit) {
  cell = trimmed(cell);
  if (cell.starts_with('+')) cell.remove_prefix(1);
  double value = unknown_number;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  const bool read = error == std::errc() && end == cell.data() + cell.size();
  return read && std::abs(value) <= limit ? value : unknown_number;
}

/// Why this cannot be a table with commas, or nothing.
std::optional<Error> another_format(std::string_view text, const std::string& name) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    return Error{"is UTF-16 text", name, "save it as UTF-8"};
  const std::string_view line = text.substr(0, text.find('\n'));
  if (line.size() == text.size() && line.find('\r') < line.size() - 1)
    return Error{"has lines that end in CR alone", name, "save it with LF or CR LF"};
  for (const char separator : {';', '\t'})
    if (line.find(',') == std::string_view::npos && line.find(separator) != std::string_view::npos)
      return Error{
          fmt::format("has {} between its columns", separator == ';' ? "semicolons" : "tabs"), name,
          "save it with commas, and with points in numbers"};
  return std::nullopt;
}

/// The same names as in the file's first line, in small letters, without what may stand around.
std::string with_plain_names(std::string_view text) {
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string made;
  for (const char c : text.substr(0, end))
    if (c != ' ' && c != '\t' && c != '"')
      made += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return made.append(text.substr(end));
}

/// A fingertip in H, which has x along the fingers and z out of the back of the hand.
std::string hand_column(std::size_t finger, Eigen::Index axis) {
  return fmt::format("hand_{}_{}_cm", hand_fingers[finger], "xyz"[axis]);
}

/// What tells one take from another.
using Key =
    std::tuple<std::string, std::string, std::string, std::string, std::string, std::string, int>;

class Reader {
 public:
  Reader(std::string_view text, std::string name, std::string task)
      : rows_(text), name_(std::move(name)), task_(std::move(task)) {}

  Expected<Takes> read() {
    if (auto ok = check_columns(); !ok) return tl::unexpected(ok.error());
    made_.files = 1;
    while (auto row = rows_.next()) {
      ++made_.rows;
      if (auto why = add(*row)) leave_out(*why);
    }
    for (Take& take : made_.takes)
      std::stable_sort(take.samples.begin(), take.samples.end(),
                       [](const HandSample& a, const HandSample& b) { return a.t < b.t; });
    if (made_.takes.empty())
      return fail(made_.rows == 0 ? "has no rows" : "has no row that can be used", name_,
                  first_.empty() ? "it needs a row a sample below the names" : first_);
    complain();
    return std::move(made_);
  }

 private:
  Expected<void> check_columns() {
    if (rows_.empty()) return fail("is empty", name_, "the first line names the columns");
    std::string missing;
    const auto need = [&](const std::string& column) {
      if (!rows_.has(column)) missing += (missing.empty() ? "" : ", ") + column;
    };
    for (const char* key : keys) need(key);
    for (const char* finger : fingers)
      for (const char* axis : {"x", "y", "z"}) need(fmt::format("thumb_{}_{}_cm", finger, axis));
    if (missing.empty()) return {};
    return fail("lacks the column(s) " + missing, name_, "the first line names the columns");
  }

  /// One line for all that is wrong with a file that was read.
  void complain() {
    std::string what = strange_unit(), hint = what.empty() ? "" : "the columns are in cm";
    if (made_.bad_rows > 0 || made_.unknown_numbers > 0) {
      what +=
          fmt::format("{}{} of {} rows left out, {} unknown numbers filled in",
                      what.empty() ? "" : "; ", made_.bad_rows, made_.rows, made_.unknown_numbers);
      hint += fmt::format("{}{}: mend or delete it", hint.empty() ? "" : "; ", first_);
    }
    if (!what.empty()) made_.complaints.push_back({what, name_, hint});
  }

  /// What the distances between thumb and fingers say of their unit, where it is not cm.
  std::string strange_unit() {
    if (spans_.empty()) return {};
    const auto middle = spans_.begin() + static_cast<std::ptrdiff_t>(spans_.size() / 2);
    std::nth_element(spans_.begin(), middle, spans_.end());
    if (*middle >= min_span && *middle <= max_span) return {};
    return fmt::format("fingertips lie {:.2g} cm from the thumb's: are these {}?", *middle,
                       *middle < min_span ? "metres" : "millimetres");
  }

  std::string_view cell(CsvRow& row, std::string_view column) {
    return rows_.has(column) ? row.text(column) : std::string_view{};
  }

  std::string name_of(CsvRow& row, std::string_view column) {
    return printable(trimmed(cell(row, column)).substr(0, max_name));
  }

  /// A number that should be there; counts where it is not.
  double measured(CsvRow& row, std::string_view column, double limit) {
    const double value = number(cell(row, column), limit);
    if (std::isnan(value)) {
      ++unknown_;
      if (first_unknown_.empty()) first_unknown_ = column;
    }
    return value;
  }

  /// Why the row cannot be used, or nothing.
  std::optional<std::string> add(CsvRow& row) {
    const std::string user = name_of(row, "user"), object = name_of(row, "object");
    const double trial = number(cell(row, "trial"), 1e9),
                 t = number(cell(row, "t_ms"), 1000 * latest);
    if (user.empty()) return "no user";
    if (object.empty()) return "no object";
    if (std::isnan(trial)) return "trial is no number";
    if (std::isnan(t)) return "t_ms is no number";
    unknown_ = 0;
    first_unknown_.clear();
    HandSample sample{.t = t / 1000};
    bool fingers_told = false;
    for (std::size_t f = 0; f < fingers.size(); ++f) {
      const auto read = [&](char axis) {
        return measured(row, fmt::format("thumb_{}_{}_cm", fingers[f], axis), 100 * farthest) / 100;
      };
      const double span = span_of(row, f);
      if (std::isfinite(span)) spans_.push_back(span);
      // The table's axes are x up, y forward, z left; W has x forward, y left, z up.
      const double up = read('x'), forward = read('y'), left = read('z');
      sample.p_thumb_tip_W[f] = {forward, left, up};
      fingers_told |= sample.p_thumb_tip_W[f].allFinite();
    }
    if (!fingers_told) return "no finger has three numbers in cm";
    read_hand(row, sample);
    if (rows_.has("hand_speed_m_s")) sample.hand_speed = measured(row, "hand_speed_m_s", fastest);
    if (rows_.has("wrist_speed_m_s"))
      sample.wrist_speed = measured(row, "wrist_speed_m_s", fastest);
    if (unknown_ > 0) note(first_unknown_ + " is no number within reason");
    made_.unknown_numbers += unknown_;
    std::string task = name_of(row, "task");
    if (task.empty()) task = task_;
    std::string grasp = name_of(row, "grasp");
    if (grasp.empty()) grasp = object;
    Take& take = place(Key{task, user, object, grasp, name_of(row, "side"), name_of(row, "action"),
                           static_cast<int>(trial)});
    take.samples.push_back(sample);
    if (!take.object) take.object = shape_of(row);
    return std::nullopt;
  }

  /// Thumb to finger as the row says it, within reach or not.
  double span_of(CsvRow& row, std::size_t finger) {
    Eigen::Vector3d told;
    for (Eigen::Index i = 0; i < 3; ++i)
      told[i] = number(cell(row, fmt::format("thumb_{}_{}_cm", fingers[finger], "xyz"[i])), 1e9);
    return told.norm();
  }

  /// Fingertips on the hand, and its size, as far as there are columns for them.
  void read_hand(CsvRow& row, HandSample& sample) {
    for (std::size_t f = 0; f < hand_fingers.size(); ++f)
      for (Eigen::Index i = 0; i < 3; ++i) {
        const std::string column = hand_column(f, i);
        if (rows_.has(column)) sample.p_HF[f][i] = measured(row, column, 100 * farthest) / 100;
      }
    if (!rows_.has("hand_scale")) return;
    sample.scale = measured(row, "hand_scale", largest_hand);
    if (!(sample.scale > 0)) sample.scale = unknown_number;
  }

  Take& place(const Key& key) {
    const auto [found, is_new] = place_.emplace(key, made_.takes.size());
    if (is_new) {
      const auto& [task, user, object, grasp, side, action, trial] = key;
      made_.takes.push_back({user, task, grasp, side, action, trial, {}, {}});
    }
    return made_.takes[found->second];
  }

  /// Nothing where the row does not say it, or says what no object is.
  std::optional<model::Shape> shape_of(CsvRow& row) {
    const auto kind = model::shape_from_string(trimmed(cell(row, "shape")));
    if (!kind) return std::nullopt;
    model::Shape made{*kind, {}};
    for (Eigen::Index i = 0; i < 3; ++i)
      made.size[i] =
          number(cell(row, size_columns[static_cast<std::size_t>(i)]), 100 * largest) / 100;
    return model::is_valid(made) ? std::optional(made) : std::nullopt;
  }

  void note(const std::string& what) {
    if (first_.empty()) first_ = fmt::format("row {}: {}", made_.rows, what);
  }

  void leave_out(const std::string& why) {
    ++made_.bad_rows;
    note(why);
  }

  CsvRows rows_;
  std::string name_, task_, first_, first_unknown_;
  std::size_t unknown_ = 0;
  std::map<Key, std::size_t> place_;
  std::vector<double> spans_;  // as the file says them
  Takes made_;
};

std::string in_small_letters(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// «1» of task1.csv, and of task1_anna.csv: people may have files of their own.
std::string task_of(const std::filesystem::path& file) {
  const std::string told = file.stem().string().substr(4);
  const std::size_t end = told.find_first_not_of("0123456789");
  const bool number_first = end != 0 && end != std::string::npos &&
                            std::string_view("_-. ").find(told[end]) != std::string_view::npos;
  return printable(number_first ? told.substr(0, end) : told);
}

Expected<std::vector<std::filesystem::path>> files_of(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  std::filesystem::directory_iterator entry(folder, error), end;
  while (!error && entry != end) {
    const std::string name = in_small_letters(entry->path().filename().string());
    if (name.starts_with("task") && name.ends_with(".csv")) files.push_back(entry->path());
    entry.increment(error);
  }
  if (error) return fail(error.message(), folder.string(), "is the path right?");
  if (files.empty())
    return fail("has no file task*.csv", folder.string(),
                "name the folder with the takes; a file of them is called task1.csv");
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

Expected<Takes> parse_takes(std::string_view text, const std::string& name,
                            const std::string& task) {
  if (auto wrong = another_format(text, name)) return tl::unexpected(std::move(*wrong));
  const std::string plain = with_plain_names(text);
  return Reader(plain, name, task).read();
}

std::string takes_csv(const std::vector<Take>& takes) {
  std::string text = "user,task,object,grasp,side,action,trial,t_ms,hand_speed_m_s,wrist_speed_m_s";
  for (const char* finger : fingers)
    for (const char axis : {'x', 'y', 'z'}) text += fmt::format(",thumb_{}_{}_cm", finger, axis);
  text += ",hand_scale";
  for (std::size_t f = 0; f < hand_fingers.size(); ++f)
    for (Eigen::Index i = 0; i < 3; ++i) text += "," + hand_column(f, i);
  text += fmt::format(",shape,{}\n", fmt::join(size_columns, ","));
  for (const Take& take : takes) {
    const std::string shape =
        take.object ? std::string(model::to_string(take.object->kind)) : std::string();
    for (const HandSample& sample : take.samples) {
      text += fmt::format("{},{},{},{},{},{},{},{:.1f},{:.4f},{:.4f}", take.user, take.task,
                          shape.empty() ? take.label : shape, take.label, take.side, take.action,
                          take.trial, 1000 * sample.t, sample.hand_speed, sample.wrist_speed);
      // W has x forward, y left, z up; the table's axes are x up, y forward, z left.
      for (const Eigen::Vector3d& tip : sample.p_thumb_tip_W)
        text += fmt::format(",{:.3f},{:.3f},{:.3f}", 100 * tip.z(), 100 * tip.x(), 100 * tip.y());
      text += fmt::format(",{:.4f}", sample.scale);
      for (const Eigen::Vector3d& tip : sample.p_HF)
        text += fmt::format(",{:.3f},{:.3f},{:.3f}", 100 * tip.x(), 100 * tip.y(), 100 * tip.z());
      text += "," + shape;
      for (Eigen::Index i = 0; i < 3; ++i)
        text += take.object ? fmt::format(",{:.3f}", 100 * take.object->size[i]) : ",";
      text += "\n";
    }
  }
  return text;
}

Expected<Takes> load_takes(const std::filesystem::path& folder) {
  const auto files = files_of(folder);
  if (!files) return tl::unexpected(files.error());
  Takes all;
  for (const auto& file : *files) {
    ++all.files;
    const auto text = read_file(file);
    auto takes =
        text ? parse_takes(*text, file.string(), task_of(file)) : tl::unexpected(text.error());
    if (!takes) {
      ++all.bad_files;
      all.complaints.push_back(takes.error());
      continue;
    }
    all.rows += takes->rows;
    all.bad_rows += takes->bad_rows;
    all.unknown_numbers += takes->unknown_numbers;
    std::move(takes->takes.begin(), takes->takes.end(), std::back_inserter(all.takes));
    std::move(takes->complaints.begin(), takes->complaints.end(),
              std::back_inserter(all.complaints));
  }
  if (all.takes.empty()) return tl::unexpected(all.complaints.front());
  return all;
}

}  // namespace prehend::demonstration
