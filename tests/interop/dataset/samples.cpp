// samples FOLDER: writes values.parquet, with a column of each type and shape that we write, and
// values.json, which says what others should find in it.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "services/recorder/core/dataset/parquet.hpp"

namespace {

using prehend::recorder::dataset::Column;
using Json = nlohmann::ordered_json;

constexpr std::size_t rows = 1000;  // levels of several bytes

/// The value of a column in a row, in lists of lists.
template <class Values>
Json nested(const Values& values, const std::vector<std::size_t>& shape, std::size_t depth,
            std::size_t& next) {
  if (depth == shape.size()) return Json(values[next++]);
  Json list = Json::array();
  for (std::size_t i = 0; i < shape[depth]; ++i)
    list.push_back(nested(values, shape, depth + 1, next));
  return list;
}

template <class Value, class Make>
Column column(const std::string& name, const std::vector<std::size_t>& shape, const Make& make) {
  std::size_t count = rows;
  for (const std::size_t extent : shape) count *= extent;
  std::vector<Value> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(make(i));
  return {name, shape, values};
}

}  // namespace

int main(int, char** argv) {
  const auto real = [](std::size_t i) { return 0.5 * static_cast<double>(i) - 100; };
  const std::vector<Column> columns{
      column<bool>("truth", {}, [](std::size_t i) { return i % 3 == 0; }),
      column<std::int64_t>("whole", {},
                           [](std::size_t i) { return static_cast<std::int64_t>(i) - 500; }),
      column<float>("single", {}, [&](std::size_t i) { return static_cast<float>(real(i)); }),
      column<double>("double", {}, [&](std::size_t i) { return real(i) * 1e100; }),
      column<std::string>("words", {},
                          [](std::size_t i) { return std::string(i % 5, 'x') + "Gl\u00fchwein"; }),
      column<float>("list", {7}, [&](std::size_t i) { return static_cast<float>(real(i)); }),
      column<double>("colours", {3, 1, 1}, real),
      column<double>("table", {2, 3}, real),
      column<std::string>("names", {2}, [](std::size_t i) { return std::to_string(i); })};
  Json expected = Json::object();
  for (const Column& each : columns) {
    Json values = Json::array();
    std::size_t next = 0;
    std::visit(
        [&](const auto& all) {
          while (next < all.size()) values.push_back(nested(all, each.shape, 0, next));
        },
        each.values);
    expected[each.name] = values;
  }
  const std::filesystem::path folder = argv[1];
  const auto bytes = prehend::recorder::dataset::parquet(columns, rows, {{"who", "we"}});
  std::ofstream(folder / "values.parquet", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  std::ofstream(folder / "values.json") << expected;
}
